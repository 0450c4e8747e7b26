import pytest

from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.nodes.kb_node.relations.relation_reports import list_locations, list_relations
from semmap.schemas import errors
from semmap.schemas.commands import Relations
from tests.kb_node.relations.entities import CORNER, ROOM, TABLE, TOP, thing

MAP = [
    ROOM,
    CORNER,
    TABLE,
    thing("cup1", (0.0, 0.0, TOP + 0.00104)),
    thing("cup2", (0.0, 0.3, TOP)),
    thing("cup3", (0.15, 0.0, TOP)),
    thing("box1", (0.0, 0.0, 0.0)),
]


def told(name, **fields):
    return {(r.relation, r.object): r for r in list_relations(Space(MAP), Relations(name=name, **fields))}


def test_texts_contain_the_measurement():
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


def test_negative_relations_of_a_pair_are_listed():
    other = told("cup1", other="cup2")
    assert not other["isOn", "cup2"].holds
    assert "it is not above any surface of cup2" in other["isOn", "cup2"].text
    assert not told("cup1", other="corner1")["isLocatedIn", "corner1"].holds


def test_milk_inside_the_fridge_is_not_on_it():
    fridge = thing("fridge1", (3.0, 0.0, 0.0))
    milk = thing("carton1", (3.0, 0.0, 0.867))
    space = Space([ROOM, fridge, milk])
    found = {r.relation: r for r in list_relations(space, Relations(name="carton1", other="fridge1"))}
    assert found.keys() == {"isOn", "isInside", "touches"}
    assert found["isInside"].holds
    assert not found["isOn"].holds
    assert "it is inside fridge1" in found["isOn"].text


def test_directions_are_relative_to_the_viewer():
    west, east = told("cup1", viewpoint=(-3.0, 0.0, 0.0, 0.0)), told("cup1", viewpoint=(3.0, 0.0, 0.0, 0.0))
    assert ("isRightOf", "cup2") in west
    assert ("isLeftOf", "cup2") in east
    south = told("cup2", viewpoint=(0.0, -3.0, 0.0, 0.0))
    assert ("isBehind", "cup1") in south
    assert ("isInFrontOf", "cup1") in told("cup2", viewpoint=(0.0, 3.0, 0.0, 0.0))


def test_an_entity_without_a_position_is_rejected():
    with pytest.raises(errors.UnknownName, match="did you mean cup1"):
        told("cup1", other="cup9")
    with pytest.raises(errors.Refused, match="has no position"):
        list(list_relations(Space([TABLE]), Relations(name="ghost1")))


def test_an_object_cannot_be_its_own_viewer():
    with pytest.raises(errors.BadRequest, match="cannot be its own viewer"):
        told("cup1", viewer="cup1")


def test_objects_in_one_place_are_not_above_each_other():
    space = Space([ROOM, TABLE, *(thing(f"cup{n}", (0.0, 0.0, TOP)) for n in (1, 2))])
    found = {r.relation for r in list_relations(space, Relations(name="cup1", other="cup2")) if r.holds}
    assert found.isdisjoint({"isUnder", "isAbove"})


def test_the_nearest_neighbours_are_listed():
    crowd = [thing(f"cup{n}", (0.2 * (n % 5) - 0.4, 0.2 * (n // 5) - 0.3, TOP)) for n in range(20)]
    found = list(
        list_relations(Space([ROOM, TABLE, *crowd]), Relations(name="cup7", viewpoint=(-3, 0, 0, 0)))
    )
    sides = {r.object for r in found if r.relation in ("isLeftOf", "isRightOf", "isInFrontOf", "isBehind")}
    assert 1 <= len(sides) <= 4
    assert sum(r.relation == "isBetween" for r in found) <= 2
    assert sum(r.relation == "isVisibleFrom" for r in found) == 1


def test_attachments_are_listed():
    wall = thing("wall1", (0.0, -2.95, 0.0), "wall", size=(6.0, 0.1, 2.5))
    picture = thing("picture1", (0.0, -2.88, 1.5), "picture", size=(0.5, 0.04, 0.4))
    assert [r.relation for r in list_locations(Space([ROOM, wall, picture]), "picture1")] == [
        "isAttachedTo",
        "isLocatedIn",
    ]


def test_contents_are_reported_as_subjects():
    found = list(list_relations(Space(MAP), Relations(name="table1")))
    assert [(r.relation, r.subject) for r in found if r.object == "table1"] == [
        ("isOn", "cup1"),
        ("isOn", "cup2"),
        ("isOn", "cup3"),
    ]
    assert not [r for r in found if r.relation == "touches"]  # what is on it touches it
    bowl = [TABLE, thing("bowl1", (0.0, 0.0, TOP)), thing("apple1", (0.0, 0.0, TOP + 0.02))]
    held = [(r.relation, r.subject, r.object) for r in list_relations(Space(bowl), Relations(name="bowl1"))]
    assert held == [("isOn", "bowl1", "table1"), ("isInside", "apple1", "bowl1")]


def test_supports_have_no_sides():
    here = [*MAP, thing("bowl1", (0.0, -0.4, TOP)), thing("apple1", (0.0, -0.4, TOP + 0.02))]
    sides = {"isLeftOf", "isRightOf", "isInFrontOf", "isBehind"}
    for name in ("cup2", "apple1", "table1"):
        seen = list_relations(Space(here), Relations(name=name, viewpoint=(-3.0, 0.0, 0.0, 0.0)))
        beside = {r.object for r in seen if r.relation in sides}
        if name == "table1":
            assert not beside & {"cup1", "apple1"}
        else:
            assert beside - {"table1"} == beside != set()
    pair = list_relations(
        Space(here), Relations(name="cup2", other="table1", viewpoint=(-3.0, 0.0, 0.0, 0.0))
    )
    assert not [r for r in pair if r.relation in sides]


@pytest.mark.parametrize(
    ("at", "said"),
    [
        ((1.5, 1.5, 0.42), "is on nothing: its bottom is 42.0 cm above the floor of corner1"),
        ((1.5, 1.5, -0.04), None),
        (
            (1.5, 1.5, -0.3),
            "is on nothing: its bottom is at a height of -30.0 cm, and it is not in a place with a floor",
        ),
        (
            (9.0, 9.0, 0.42),
            "is on nothing: its bottom is at a height of 42.0 cm, and it is not in a place with a floor",
        ),
        ((0.0, 0.0, TOP + 0.2), "is on nothing: its bottom is 20.0 cm above a surface of table1"),
        ((0.0, 0.0, TOP), None),
        ((1.5, 1.5, 0.0), None),
        ((9.0, 9.0, 0.0), None),
    ],
)
def test_a_floating_object_is_on_nothing(at, said):
    space = Space([ROOM, CORNER, TABLE, thing("egg1", at)])
    found = [
        r for r in list_relations(space, Relations(name="egg1")) if r.relation == "isOn" and not r.object
    ]
    assert [r.text.removeprefix("egg1 ").partition(" that has")[0] for r in found] == ([said] if said else [])
    assert not any(r.holds for r in found)
    fixed = list(list_relations(space, Relations(name="egg1"), is_fixed=True))
    assert all(r.object for r in fixed)


def test_the_height_of_a_wall_cupboard_is_not_that_below_its_contents():
    table, shelf = thing("table1", (0.0, 0.0, 0.0), "table"), thing("shelf1", (0.0, 0.0, 1.1), "bookshelf")
    board = min(support.height for support in Space([shelf]).solids["shelf1"].supports)
    space = Space([ROOM, table, shelf, thing("cup1", (0.0, 0.0, board))])
    assert [r.object for r in list_locations(space, "cup1")] == ["shelf1", "kitchen1"]
    (found,) = (r for r in list_relations(space, Relations(name="shelf1")) if not r.object)
    assert found.text.endswith("cm above a surface of table1")


def test_an_object_over_an_edge_is_on_nothing():
    edge = TABLE.size_m[0] / 2
    box = thing("box1", (edge + 0.09, 0.0, TOP), size=(0.2, 0.2, 0.1))
    (found,) = (r for r in list_relations(Space([ROOM, TABLE, box]), Relations(name="box1")) if not r.object)
    assert found.text.endswith("level with a surface of table1, but 8% of its base is over it")


def test_attached_objects_and_flat_maps_are_not_reported_as_floating():
    wall = thing("wall1", (0.0, 0.0, 0.0), size=(0.1, 3.0, 2.5))
    picture = thing("picture1", (0.07, 0.0, 1.3))
    assert all(r.object for r in list_relations(Space([wall, picture]), Relations(name="picture1")))
    plan = [thing("lamp1", (0.0, 0.0, 0.0)), thing("rug1", (0.0, 0.0, 0.0))]
    assert all(r.object for r in list_relations(Space(plan), Relations(name="lamp1")))


def test_an_unknown_size_is_reported():
    relic = thing("relic1", (0.0, 0.0, TOP))
    (found,) = (
        r for r in list_relations(Space([ROOM, TABLE, relic]), Relations(name="relic1")) if not r.object
    )
    assert "set a size: semmap update relic1 --size X Y Z" in found.text


def test_an_object_of_unknown_size_is_near_nothing():
    relic = thing("relic1", (0.0, 0.0, TOP))
    space = Space([ROOM, TABLE, thing("cup1", (0.1, 0.0, TOP)), relic])
    assert [r.relation for r in list_relations(space, Relations(name="relic1")) if r.holds] == ["isLocatedIn"]
    pair = list(list_relations(space, Relations(name="cup1", other="relic1")))
    assert not any(r.holds for r in pair)
    assert "relic1" not in {r.object for r in list_relations(space, Relations(name="cup1"))}
