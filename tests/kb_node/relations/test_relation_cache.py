"""Relations of single pairs agree with `list` and `relations`."""

import math

import pytest

from semmap.nodes.kb_node.relations.measuring.viewing import View
from semmap.nodes.kb_node.relations.relation_cache import RelationCache
from semmap.nodes.kb_node.relations.relation_reports import list_relations_from_view
from semmap.nodes.kb_node.relations.selection import select_entities
from semmap.schemas import errors
from semmap.schemas.relations import Where


@pytest.fixture
def space(flat):
    return flat.places.space()


@pytest.mark.parametrize("where", ["on", "near", "in_"])
def test_related_agrees_with_list(flat, space, where):
    asked, there = RelationCache(space), tuple(flat.entities())
    relation = {"on": "isOn", "near": "isNear", "in_": "isInside"}[where]
    for other in ("table1", "kitchen1", "bowl1", "desk1"):
        try:
            listed = {e.name for e in select_entities(space, there, Where(**{where: other}), there)}
        except errors.Refused:
            continue
        found = {e.name for e in there if asked.related(relation, e.name, other)}
        hanging = found - listed
        assert listed <= found
        assert not hanging or (where == "on" and all(flat.entity(name).fixed for name in hanging))


def test_sides_agree_with_relations(space):
    view = View.at(8.2, 0.9, 0.0, math.pi / 2)
    asked = RelationCache(space, view)
    told = {
        (r.relation, r.object)
        for r in list_relations_from_view(space, "chair1", view, None)
        if r.relation.startswith("isL")
    }
    assert told
    assert all(asked.related(relation, "chair1", other) for relation, other in told)
    assert not asked.related("isLeftOf", "bowl1", "table1")  # it stands on it


def test_sides_require_a_viewer(space):
    with pytest.raises(errors.BadRequest, match="--from VIEWER"):
        RelationCache(space).bearing("cup1")
    with pytest.raises(errors.BadRequest):
        RelationCache(space).related("isBehind", "cup1", "laptop1")
    assert not RelationCache(space).has_viewer
    assert RelationCache(space, View.at(0, 0, 0, 0)).has_viewer


def test_an_entity_without_a_position_has_no_relations(space):
    asked = RelationCache(space, View.at(0, 0, 0, 0))
    assert asked.position("missing") is asked.size("missing") is None
    assert asked.distance("missing", "cup1") == asked.distance_from_viewer("missing") == math.inf
    assert not asked.related("isOn", "missing", "table1")
    assert not asked.holds_anything("missing")
    assert asked.spatial_relations("missing") == ()
    assert asked.between("missing", "cup1") == frozenset()


def test_spatial_relations_are_nearest_first(space):
    assert RelationCache(space).spatial_relations("apple1") == (
        ("isInside", "bowl1"),
        ("isLocatedIn", "dining_corner1"),
    )
    assert RelationCache(space).holds_anything("bowl1")
    assert not RelationCache(space).holds_anything("plate1")


def test_too_many_pairs_are_rejected(space, monkeypatch):
    monkeypatch.setattr("semmap.nodes.kb_node.relations.relation_cache.MOST_PAIRS", 10)
    asked = RelationCache(space)
    for _ in range(10):
        asked.related("isOn", "plate1", "table1")
    with pytest.raises(errors.BadRequest, match="more than 10 pairs"):
        asked.between("chair1", "chair2")
