"""Explanations of why a relation does not hold."""

import pytest

from semmap.nodes.kb_node.relations.measuring.relation_table import PAIR_RELATIONS
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.nodes.kb_node.relations.relation_reports import explain_relation, list_relations
from semmap.schemas import errors
from semmap.schemas.commands import Relations
from semmap.schemas.relations import PHRASES
from tests.kb_node.relations.entities import CORNER, ROOM, TABLE, TOP, thing

FRIDGE = thing("fridge1", (2.0, -2.0, 0.0))
TRAY = thing("tray1", (0.0, 0.0, TOP))
MAP = [
    ROOM,
    CORNER,
    TABLE,
    FRIDGE,
    TRAY,
    thing("plate1", (-TRAY.size_m[0] / 2 - 0.15, 0.0, TOP)),
    thing("cup1", (0.0, 0.0, TOP + 0.03)),
    thing("cup2", (0.2, 0.4, TOP + 0.02)),
    thing("cup3", (0.3, 0.0, TOP + 0.3)),
    thing("bowl1", (0.0, -0.4, TOP)),
    thing("apple1", (0.0, -0.4, TOP + 0.02)),
    thing("milk1", (2.0, -2.0, 0.867), "carton"),
    thing("box1", (0.0, 0.0, 0.0)),
    thing("shelf1", (-2.0, 0.0, 0.0), "bookshelf"),
    thing("thing1", (1.0, 1.0, 0.0), "unheard of"),
    thing("can1", (-1.0, -1.0, 0.0)),
    thing("egg1", (-1.0, -1.0, 0.0)),
    thing("bucket1", (-2.0, -2.0, 0.0)),
    thing("board1", (-2.0, -2.0, 0.05), "", size=(0.02, 0.4, 0.1)),
]


def told(name, relation, other):
    return explain_relation(Space(MAP), name, relation, other)


@pytest.mark.parametrize(
    ("name", "relation", "other", "reason"),
    [
        ("apple1", "isOn", "table1", "it is inside bowl1, which is on table1"),
        ("cup1", "isOn", "table1", "it is on tray1, which is on table1"),
        ("milk1", "isOn", "fridge1", "it is inside fridge1, and an object inside another is not also on it"),
        ("cup1", "isOn", "cup2", "it is not above any surface of cup2"),
        ("cup3", "isOn", "table1", "cm above the nearest surface of table1"),
        ("box1", "isOn", "table1", "cm below the nearest surface of table1"),
        ("cup1", "isOn", "kitchen1", "kitchen1 is a place"),
        ("thing1", "isOn", "table1", "the size of thing1 is unknown"),
        ("apple1", "isInside", "table1", "table1 has no known hollow"),
        ("cup1", "isInside", "bowl1", "none of its volume is within a hollow of bowl1"),
        ("egg1", "isInside", "can1", "not all of it is within the hollow of can1, which is closed"),
        ("apple1", "isInside", "can1", "none of its volume is within a hollow of can1"),
        ("board1", "isInside", "bucket1", "it is too large for the hollow of bucket1"),
        ("cup1", "isLocatedIn", "table1", "table1 is not a place"),
        ("cup1", "isLocatedIn", "corner1", "m from it"),
        ("cup1", "isAttachedTo", "table1", "it is on tray1, so it is not attached to a side"),
        ("cup1", "touches", "cup2", "apart (touches allows up to 1.5 mm)"),
        ("cup1", "isUnder", "table1", "no part of table1 is above the top of cup1"),
        ("egg1", "isUnder", "can1", "each part of can1 starts below the top of egg1"),
        ("cup1", "isUnder", "shelf1", "seen from above, they are"),
        ("table1", "isAbove", "cup1", "no part of table1 is above the top of cup1"),
        ("cup2", "isUnder", "table1", "it is on table1"),
        ("cup1", "isNear", "shelf1", "isNear allows up to"),
        ("cup1", "isNextTo", "shelf1", "isNear allows up to"),
        ("plate1", "isNextTo", "cup1", "but plate1 is on table1 and cup1 is on tray1"),
        ("cup1", "isLeftOf", "shelf1", "relative to the front of shelf1, it is in front of it"),
        ("shelf1", "isVisibleFrom", "cup1", "0% of the lines of sight reach it"),
        ("cup1", "isOn", "cup1", "an object has no relation to itself"),
    ],
)
def test_explanations_of_absent_relations(name, relation, other, reason):
    found = told(name, relation, other)
    assert not found.holds
    assert reason in found.text
    assert found.text.startswith(f"{name} ")


@pytest.mark.parametrize(
    ("height_m", "reason", "inverse_reason"),
    [
        (
            0.75,
            "its top is level with the underside of high1, {}",
            "its underside is level with the top of low1, {}",
        ),
        (
            0.745,
            "its top is 5.0 mm above the underside of high1, {}; they overlap",
            "its underside is 5.0 mm below the top of low1, {}; they overlap",
        ),
        (0.85, "its top is 10.0 cm below high1, {}", "its underside is 10.0 cm above low1, {}"),
    ],
)
@pytest.mark.parametrize(
    ("widths_m", "over", "under"),
    [
        ((0.4, 0.8), "which is over 50% of it", "50% of which is under it"),
        ((0.8, 0.4), "50% of which is over it", "which is under 50% of it"),
    ],
)
def test_what_is_above_covers_a_share_of_the_smaller_one(
    height_m, reason, inverse_reason, widths_m, over, under
):
    low = thing("low1", (0.0, 0.0, 0.0), "", size=(widths_m[0], widths_m[0], 0.75))
    high = thing("high1", (0.4, 0.0, height_m), "", size=(widths_m[1], widths_m[1], 0.1))
    space = Space([low, high])
    one, other = space.solids["low1"], space.solids["high1"]
    is_under, is_above = PAIR_RELATIONS["isUnder"], PAIR_RELATIONS["isAbove"]
    assert is_under.explain(space, one, other, is_under.measure(space, one, other)) == reason.format(over)
    assert is_above.explain(space, other, one, is_above.measure(space, other, one)) == inverse_reason.format(
        under
    )


@pytest.mark.parametrize("relation", PHRASES)
def test_there_is_a_reason_for_each_relation(relation):
    for other in ("table1", "kitchen1", "apple1", "thing1", "cup1"):
        found = told("cup1", relation, other)
        assert found.relation == relation
        assert found.text


def test_a_supported_object_touches_in_both_directions():
    """Within the pose tolerance: the cup is 2 cm above the table in the map."""
    assert told("cup2", "touches", "table1").text.startswith(
        "cup2 touches table1, because cup2 is on table1:"
    )
    assert told("table1", "touches", "cup2").holds
    pair = list_relations(Space(MAP), Relations(name="table1", other="cup2"))
    assert "touches" in {relation.relation for relation in pair if relation.holds}
    assert not told("apple1", "touches", "table1").holds


def test_an_object_has_no_relation_to_itself():
    with pytest.raises(errors.BadRequest, match="name two different objects"):
        list(list_relations(Space(MAP), Relations(name="cup1", other="cup1")))


def test_two_attached_objects_have_no_support():
    hanging = [thing(f"cup{n}", (0.09 * n, 3.0, 1.4 + 0.06 * n)) for n in (1, 2)]
    found = explain_relation(Space([ROOM, *hanging]), "cup1", "isNextTo", "cup2")
    assert "neither has a known support" in found.text


def test_no_length_of_zero_is_printed():
    assert explain_relation(
        Space([TABLE, thing("cup1", (0.0, 0.0, TOP))]), "cup1", "touches", "table1"
    ).text == ("cup1 touches table1: they meet")


def test_a_crowd_is_named_as_the_reason():
    cans = [thing(f"can{k}", (0.0, 0.0, TOP)) for k in range(150)]
    upper = thing("can999", (0.0, 0.0, TOP + cans[0].size_m[2]))
    crowd = Space([ROOM, TABLE, *cans, upper])
    assert not crowd.counts(crowd.solids["can999"])
    found = explain_relation(crowd, "can999", "isOn", "can1")
    assert not found.holds
    assert found.text.endswith(
        "too many objects are here to compare all of them, and can1 is not among the largest"
    )
    assert explain_relation(crowd, "can149", "isOn", "table1").holds
    assert explain_relation(Space([TABLE, cans[1], upper]), "can999", "isOn", "can1").holds


def test_a_supported_object_has_no_side():
    space = Space([TABLE, thing("cup1", (0.2, 0.2, TOP))])
    for name, other, borne in (("cup1", "table1", "it is on table1"), ("table1", "cup1", "cup1 is on it")):
        found = explain_relation(space, name, "isLeftOf", other)
        assert not found.holds
        assert found.text.endswith(
            f"{borne}; side relations are not defined between an object and its support"
        )
