"""Next to, between, and attached to."""

import pytest
from msgspec import structs

from semmap.nodes.kb_node.relations.facts.place_facts import Facts
from semmap.nodes.kb_node.relations.measuring.arrangement import (
    find_attachments,
    find_between,
    is_supported,
    measure_attachment,
    measure_next_to,
    stands_on_floor,
    stands_on_ground,
)
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.schemas.attachments import IS_GRASPED_BY
from tests.kb_node.relations.entities import PROVENANCE, ROOM, TABLE, TOP, thing

WALL = thing("wall1", (0.0, 2.0, 0.0), size=(0.1, 4.0, 2.5), turn=(0.7071068, 0.0, 0.0, 0.7071068))
PICTURE = thing("picture1", (0.0, 1.93, 1.4), turn=(0.7071068, 0.0, 0.0, -0.7071068))
CUPS = [thing(f"cup{n}", (0.18 * n, 0.0, TOP)) for n in (1, 2, 3)]


def space(*entities):
    return Space([ROOM, TABLE, *entities])


@pytest.mark.parametrize(
    ("other", "holds"),
    [
        pytest.param(thing("plate1", (0.2, 0.2, TOP)), True, id="on the same table"),
        pytest.param(thing("plate1", (0.2, 0.2, 0.0)), None, id="under the table, far below"),
        pytest.param(thing("stool1", (0.35, 0.0, 0.25)), False, id="near, but not on the table"),
        pytest.param(thing("plate1", (0.2, 2.9, TOP)), None, id="far away"),
    ],
)
def test_next_to(other, holds):
    cup = thing("cup1", (0.0, 0.0, TOP))
    there = space(cup, other)
    made = measure_next_to(there, there.solids["cup1"], there.solids[other.name])
    assert (None if made is None else made.holds) == holds


def test_an_object_between_two_prevents_next_to():
    there = space(*CUPS)
    first, middle, last = (there.solids[cup.name] for cup in CUPS)
    assert find_between(there, first, last) == [middle]
    assert find_between(there, first, middle) == []
    made = measure_next_to(there, first, last)
    assert made is None or not made.holds
    assert measure_next_to(there, first, middle).holds


def test_a_picture_on_a_wall_is_attached_to_it():
    there = space(WALL, PICTURE)
    picture, wall = there.solids["picture1"], there.solids["wall1"]
    assert measure_attachment(there, picture, wall).holds
    assert measure_attachment(there, wall, picture) is None
    assert list(find_attachments(there, picture)) == [wall]


def test_a_standing_object_is_not_attached_to_the_wall():
    there = space(WALL, thing("cabinet1", (0.0, 1.72, 0.0)))
    assert list(find_attachments(there, there.solids["cabinet1"])) == []


def test_an_attachment_ends_with_a_support():
    facts = Facts()
    facts.update([ROOM, WALL, PICTURE])
    hangs = ("picture1", "isAttachedTo", "wall1")
    assert hangs in facts
    box = thing("box1", (0.0, 1.85, 0.0), size=(0.3, 0.3, 1.4))
    assert hangs in facts.update([box]).gone
    assert hangs in facts.update([], ["box1"]).come


def block(name, x, y=0.0, z=0.0, size=(0.2, 0.2, 0.5)):
    return thing(name, (x, y, z), "", size=size)


ENDS = [block("a1", 0.0), block("b1", 2.0)]


@pytest.mark.parametrize(
    ("third", "is_between"),
    [
        (block("c1", 1.0), True),
        (block("c1", 0.3), True),
        (block("c1", 1.0, 0.08), True),
        (block("c1", 1.0, 0.15), False),  # most of it is beside the strip
        (block("c1", 1.0, z=0.4), True),
        (block("c1", 1.0, z=0.6), False),  # above both
        (block("c1", 1.0, z=-0.7), False),  # below both
        (block("c1", 2.5), False),  # behind one of them
        (block("c1", -0.5), False),
        (thing("c1", (1.0, 0.0, 0.0), "unheard of"), False),
        (thing("c1", (1.0, 0.0, 0.0), size=(0.2, 0.2, 0.5), place=True), False),
    ],
)
def test_an_object_is_between_two_on_their_strip_and_at_their_height(third, is_between):
    there = Space([*ENDS, third])
    one, other = (there.solids[name] for name in ("a1", "b1"))
    expected = [there.solids["c1"]] if is_between else []
    assert find_between(there, one, other) == find_between(there, other, one) == expected


def test_objects_between_two_are_ordered_by_name_and_others_are_passed_over():
    between = [block("d1", 0.6), block("c1", 1.4), block("e1", 1.0)]
    others = [
        block("low1", 0.8, z=-0.7),
        block("high1", 1.2, z=0.6),
        block("aside1", 0.9, 0.15),
        block("far1", -0.5, 0.5),
        thing("room1", (1.0, 0.0, 0.0), size=(0.2, 0.2, 0.5), place=True),
        thing("point1", (1.1, 0.0, 0.0), "unheard of"),
    ]
    for there in ([*ENDS, *between, *others], [*others, *between, *ENDS]):
        space = Space(there)
        found = find_between(space, space.solids["a1"], space.solids["b1"])
        assert [solid.name for solid in found] == ["c1", "d1", "e1"]


BOWL = thing("bowl1", (0.0, 0.0, 0.0), "bowl", size=(0.6, 0.6, 0.3))


@pytest.mark.parametrize(
    ("others", "one", "other", "share"),
    [
        pytest.param([], (0.0, 0.0), (0.14, 0.0), 1.0, id="on one floor without a place"),
        pytest.param([], (0.0, 0.0), (0.14, 0.08), 0.0, id="at different heights"),
        pytest.param([ROOM], (0.0, 0.0), (0.14, 0.0), 1.0, id="on the floor of a room"),
        pytest.param([TABLE], (0.0, TOP), (0.14, TOP), 1.0, id="on one table"),
        pytest.param([ROOM, TABLE], (0.0, TOP), (0.25, 0.0), None, id="on and below a table"),
        pytest.param([BOWL], (-0.07, 0.1), (0.07, 0.1), 1.0, id="in one bowl"),
        pytest.param([BOWL], (0.2, 0.1), (0.36, 0.0), 0.0, id="in and beside a bowl"),
    ],
)
def test_two_objects_next_to_each_other_share_their_support(others, one, other, share):
    ends = [block(n, x, z=z, size=(0.1, 0.1, 0.1)) for n, (x, z) in (("a1", one), ("b1", other))]
    there = Space([*others, *ends])
    for first, second in (("a1", "b1"), ("b1", "a1")):
        made = measure_next_to(there, there.solids[first], there.solids[second])
        if share is None:
            assert made is None
        else:
            assert made.holds == (share > 0.0)
            assert share > 0.0 or made.share == 0.0


def held(entity):
    return structs.replace(entity, properties={IS_GRASPED_BY: "robot1"}, grip_provenance=PROVENANCE)


@pytest.mark.parametrize(
    ("entity", "places", "on_floor", "on_ground", "supported"),
    [
        pytest.param(block("a1", 2.0), [ROOM], True, True, True, id="on the floor"),
        pytest.param(block("a1", 2.0, z=0.5), [ROOM], False, False, False, id="in the air"),
        pytest.param(block("a1", 0.0, z=TOP), [ROOM], False, False, True, id="on a table"),
        pytest.param(held(block("a1", 2.0, z=0.5)), [ROOM], False, False, True, id="held"),
        pytest.param(block("a1", 20.0), [ROOM], False, True, False, id="outside, at height 0"),
        pytest.param(block("a1", 20.0, z=0.5), [ROOM], False, False, False, id="outside, in the air"),
        pytest.param(
            block("a1", 2.0, z=3.0),
            [thing("attic1", (2.0, 0.0, 3.0), size=(1.0, 1.0, 2.0), place=True)],
            *(True, True, True),
            id="on the floor of an attic",
        ),
    ],
)
def test_what_holds_an_object(entity, places, on_floor, on_ground, supported):
    there = Space([*places, TABLE, entity])
    solid = there.solids["a1"]
    assert stands_on_floor(there, solid) == on_floor
    assert stands_on_ground(there, solid) == on_ground
    assert is_supported(there, solid) == supported


@pytest.mark.parametrize(
    "entity",
    [
        pytest.param(held(PICTURE), id="held"),
        pytest.param(structs.replace(PICTURE, size_m=None, model="unheard of"), id="of unknown size"),
        pytest.param(thing("picture1", (0.0, 1.5, 1.4), turn=(0.7071068, 0.0, 0.0, -0.7071068)), id="away"),
        pytest.param(thing("picture1", (0.0, 1.93, 2.4), size=(0.6, 0.04, 0.5)), id="above most of the wall"),
        pytest.param(thing("picture1", (0.0, 1.93, 0.02), size=(0.6, 0.04, 0.5)), id="near the floor"),
    ],
)
def test_what_is_not_attached_to_a_wall(entity):
    there = space(WALL, entity)
    assert list(find_attachments(there, there.solids["picture1"])) == []
    room = thing("picture1", (0.0, 1.93, 1.4), size=(0.6, 0.04, 0.5), place=True)
    assert (
        measure_attachment(space(WALL, room), space(WALL, room).solids["picture1"], there.solids["wall1"])
        is None
    )
