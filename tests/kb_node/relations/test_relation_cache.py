"""Relations of single pairs agree with `list` and `relations`."""

import math

import pytest

from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.nodes.kb_node.relations.measuring.viewing import View
from semmap.nodes.kb_node.relations.relation_cache import RelationCache
from semmap.nodes.kb_node.relations.relation_reports import list_relations_from_view
from semmap.nodes.kb_node.relations.selection import select_entities
from semmap.schemas import errors
from semmap.schemas.relations import Where
from tests.kb_node.relations.entities import CORNER, ROOM, TABLE, TOP, thing

KITCHEN = [
    ROOM,
    CORNER,
    TABLE,
    thing("bowl1", (0.1, 0.0, TOP)),
    thing("apple1", (0.1, 0.0, TOP + 0.02)),
    thing("cup1", (-0.08, 0.0, TOP)),
    thing("lamp1", (2.0, 2.0, 0.0)),
    thing("ball1", (-2.5, 0.0, 0.5), "", size=(0.2, 0.2, 0.2)),
    thing("relic1", (-1.0, -2.0, 0.0), "unheard of"),
]


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


@pytest.mark.parametrize(
    ("fact", "holds"),
    [
        (("isOn", "cup1", "table1"), True),
        (("isOn", "apple1", "table1"), True),  # through the bowl
        (("isOn", "table1", "cup1"), False),
        (("isInside", "apple1", "bowl1"), True),
        (("isInside", "bowl1", "apple1"), False),
        (("isInside", "cup1", "kitchen1"), True),
        (("isLocatedIn", "lamp1", "corner1"), True),
        (("isLocatedIn", "cup1", "corner1"), False),
        (("isNear", "cup1", "bowl1"), True),
        (("isNear", "cup1", "table1"), False),  # it is on it
        (("isNear", "cup1", "lamp1"), False),
        (("isNextTo", "cup1", "bowl1"), True),
        (("isNextTo", "cup1", "lamp1"), False),
        (("touches", "cup1", "table1"), True),
        (("isLeftOf", "cup1", "bowl1"), True),
        (("isRightOf", "cup1", "bowl1"), False),
        (("isLeftOf", "cup1", "table1"), False),  # it is on it
        (("isLeftOf", "table1", "cup1"), False),
        (("isOn", "cup1", "cup1"), False),
    ],
)
def test_relations_of_a_pair_are_measured_once(fact, holds):
    asked = RelationCache(Space(KITCHEN), View.at(0.0, -3.0, 0.0, math.pi / 2))
    assert asked.related(*fact) == holds
    assert asked.related(*fact) == holds


def test_suppressed_facts_do_not_count():
    left_out = {("apple1", "isInside", "bowl1"), ("cup1", "isOn", "table1")}
    asked = RelationCache(Space(KITCHEN), left_out=left_out)
    assert not asked.related("isInside", "apple1", "bowl1")
    assert not asked.related("isOn", "apple1", "table1")
    assert not asked.related("isOn", "cup1", "table1")
    assert asked.related("isOn", "bowl1", "table1")


def test_positions_sizes_and_distances():
    asked = RelationCache(Space(KITCHEN), View.at(0.0, -3.0, 0.0, math.pi / 2))
    assert asked.position("cup1") == (-0.08, 0.0, TOP)
    assert asked.size("ball1") == (0.2, 0.2, 0.2)
    assert asked.size("relic1") is None
    assert asked.distance("cup1", "bowl1") == pytest.approx(0.18)
    assert asked.distance("cup1", "missing") == math.inf
    assert asked.distance_from_viewer("bowl1") == pytest.approx(math.hypot(0.1, 3.0))


@pytest.mark.parametrize("yaw", [0.0, 0.7, math.pi / 2, -2.0])
def test_bearings_are_to_the_left_of_the_viewing_direction(yaw):
    asked = RelationCache(Space(KITCHEN), View.at(0.0, -3.0, 0.0, yaw))
    for name, (x, y) in {"cup1": (-0.08, 3.0), "bowl1": (0.1, 3.0), "relic1": (-1.0, 1.0)}.items():
        expected = math.remainder(math.atan2(y, x) - yaw, 2 * math.pi)
        assert asked.bearing(name) == pytest.approx(expected)
    assert asked.bearing("missing") == math.inf


@pytest.mark.parametrize(
    ("name", "holds_anything", "is_on_floor", "relations"),
    [
        ("table1", True, True, [("isLocatedIn", "kitchen1")]),
        ("bowl1", True, False, [("isOn", "table1"), ("isLocatedIn", "kitchen1")]),
        ("apple1", False, False, [("isInside", "bowl1"), ("isLocatedIn", "kitchen1")]),
        ("lamp1", False, True, [("isLocatedIn", "corner1")]),
        ("ball1", False, False, [("isLocatedIn", "kitchen1")]),
        ("kitchen1", True, False, []),
        ("corner1", True, False, []),
        ("missing", False, False, []),
    ],
)
def test_what_an_object_holds_and_where_it_is(name, holds_anything, is_on_floor, relations):
    asked = RelationCache(Space(KITCHEN))
    assert asked.holds_anything(name) == holds_anything
    assert asked.is_on_floor(name) == is_on_floor
    assert asked.spatial_relations(name) == tuple(relations)


def test_an_object_between_two_is_found_in_either_order():
    posts = [thing(f"post{k}", (float(k), 0.0, 0.0), "", size=(0.2, 0.2, 0.5)) for k in range(3)]
    asked = RelationCache(Space(posts))
    assert asked.between("post0", "post2") == asked.between("post2", "post0") == {"post1"}
    assert asked.between("post0", "post1") == asked.between("post0", "missing") == set()
    assert RelationCache(Space([thing("k1", (0, 0, 0), place=True)])).holds_anything("k1") is False
