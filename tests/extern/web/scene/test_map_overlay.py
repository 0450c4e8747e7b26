"""Relations as lines."""

from semmap.nodes.extern.web.scene.map_overlay import path_lines, relation_lines
from semmap.schemas.relations import Relation

MIDDLES = {
    "cup1": (0.0, 0.0, 1.0),
    "table1": (1.0, 0.0, 0.4),
    "milk1": (0.0, 1.0, 1.0),
    "jug1": (2.0, 2.0, 1.0),
}


def relation(kind, subject, object_, gap_m=0.0, **more):
    return Relation(relation=kind, subject=subject, object=object_, gap_m=gap_m, **more)


def texts(of, *relations):
    return {(line.a, line.b): line.text for line in relation_lines(of, relations, MIDDLES)}


def test_each_related_entity_has_one_line_with_relations_and_distances():
    found = texts(
        "cup1",
        relation("isNear", "cup1", "milk1", 0.155),
        relation("isLeftOf", "cup1", "milk1", 1.25),
        relation("isOn", "cup1", "table1"),
    )
    assert found == {
        (MIDDLES["cup1"], MIDDLES["milk1"]): "near 16 cm, left of 1.25 m",
        (MIDDLES["cup1"], MIDDLES["table1"]): "on",
    }


def test_supported_entities_are_named():
    assert list(texts("table1", relation("isOn", "cup1", "table1")).values()) == ["cup1 on"]


def test_implied_relations_and_those_that_do_not_hold_are_not_shown():
    found = texts(
        "cup1",
        relation("isNextTo", "cup1", "milk1", 0.1),
        relation("isNear", "cup1", "milk1", 0.1),
        relation("isOn", "cup1", "jug1", holds=False),
    )
    assert list(found.values()) == ["next to 10 cm"]


def test_between_has_two_lines():
    found = texts("cup1", relation("isBetween", "cup1", "milk1", and_object="jug1"))
    assert set(found.values()) == {"between"}
    assert len(found) == 2


def test_places_have_no_lines():
    assert texts("cup1", relation("isLocatedIn", "cup1", "kitchen1")) == {}
    assert texts("ghost", relation("isOn", "ghost", "table1")) == {}


def test_a_drive_is_a_line_through_its_points_with_a_cross_at_the_goal():
    lines = path_lines(((1.0, 0.0), (1.0, 2.0)), (0.0, 0.0, 0.5))
    assert lines.shape == (4, 2, 3)
    assert lines[:2, :, :2].tolist() == [[[0.0, 0.0], [1.0, 0.0]], [[1.0, 0.0], [1.0, 2.0]]]
    assert lines[2:, :, :2].mean(axis=1).tolist() == [[1.0, 2.0], [1.0, 2.0]]
    assert ((lines[:, :, 2] > 0.5) & (lines[:, :, 2] < 0.6)).all()
