import pytest

from nodes.kb_node.relations.space import Space
from nodes.kb_node.relations.telling import relations
from schemas import errors
from schemas.commands import Relations
from tests.kb_node.relations.made import CORNER, ROOM, TABLE, TOP, thing

MAP = [
    ROOM,
    CORNER,
    TABLE,
    thing("cup1", (0.0, 0.0, TOP + 0.001)),
    thing("cup2", (0.0, 0.3, TOP)),
    thing("cup3", (0.15, 0.0, TOP)),
    thing("box1", (0.0, 0.0, 0.0)),
]


def told(name, **fields):
    return {(r.relation, r.object): r for r in relations(Space(MAP), Relations(name=name, **fields))}


def test_the_measurement_is_said():
    on = told("cup1")["isOn", "table1"]
    assert on.text == (
        f"cup1 is on table1: its bottom is 1.0 mm above a surface of table1, at {100 * TOP:.1f} cm,"
        " and 100% of its base is over it"
    )
    assert on.gap_m == 0.001
    assert on.share == 1.0


def test_neighbours():
    found = told("cup1")
    assert ("isNextTo", "cup3") in found
    assert ("isBetween", "cup1") not in found
    assert ("isUnder", "table1") in told("box1")
    assert ("isAbove", "box1") in told("table1")


def test_of_a_pair_what_does_not_hold_is_told_too():
    other = told("cup1", other="cup2")
    assert not other["isOn", "cup2"].holds
    assert "it is over no surface of cup2" in other["isOn", "cup2"].text
    assert not told("cup1", other="corner1")["isLocatedIn", "corner1"].holds


def test_why_milk_is_not_on_the_fridge_whose_board_it_stands_on():
    fridge = thing("fridge1", (3.0, 0.0, 0.0))
    milk = thing("carton1", (3.0, 0.0, 0.867))
    space = Space([ROOM, fridge, milk])
    found = {r.relation: r for r in relations(space, Relations(name="carton1", other="fridge1"))}
    assert found.keys() == {"isOn", "isInside", "touches"}
    assert found["isInside"].holds
    assert not found["isOn"].holds
    assert "it is inside fridge1" in found["isOn"].text


def test_directions_are_the_viewer_s():
    west, east = told("cup1", viewpoint=(-3.0, 0.0, 0.0, 0.0)), told("cup1", viewpoint=(3.0, 0.0, 0.0, 0.0))
    assert ("isRightOf", "cup2") in west
    assert ("isLeftOf", "cup2") in east
    south = told("cup2", viewpoint=(0.0, -3.0, 0.0, 0.0))
    assert ("isBehind", "cup1") in south
    assert ("isInFrontOf", "cup1") in told("cup2", viewpoint=(0.0, 3.0, 0.0, 0.0))


def test_who_is_nowhere():
    with pytest.raises(errors.UnknownName, match="did you mean cup1"):
        told("cup1", other="cup9")
    with pytest.raises(errors.Refused, match="has no position"):
        list(relations(Space([TABLE]), Relations(name="ghost1")))


def test_nothing_is_seen_from_itself():
    with pytest.raises(errors.BadRequest, match="cannot be seen from itself"):
        told("cup1", viewer="cup1")
