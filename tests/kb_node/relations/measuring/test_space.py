"""Spatial relations in small situations, compared with human judgement."""

import math
from contextlib import suppress

import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec import structs

from semmap.nodes.kb_node.relations.lazy_space import LazySpace
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.ontology.model_shapes import shapes
from semmap.schemas.attachments import IS_GRASPED_BY
from tests.kb_node.relations.entities import CORNER, PROVENANCE, ROOM, TABLE, TOP, thing

LYING = (math.cos(math.pi / 4), 0.0, math.sin(math.pi / 4), 0.0)
BOWL = thing("bowl1", (0.1, 0.0, TOP))
BOOK = thing("book1", (0.0, 0.3, TOP))
SHELF = thing("bookshelf1", (2.0, 0.0, 0.0))
BOARDS = [surface.height for surface in shapes()["bookshelf"].surfaces]


def said(name, *entities):
    space = Space([ROOM, CORNER, TABLE, *entities])
    container, supports, place = space.spatial_relations(space.solids[name])
    assert len(supports) < 2
    return tuple(found and found[0].name for found in (container, *(supports or (None,)), place))


@pytest.mark.parametrize(
    ("entity", "others", "expected"),
    [
        pytest.param(thing("cup1", (0.0, 0.0, TOP)), [], (None, "table1", "kitchen1"), id="on a table"),
        pytest.param(
            thing("cup1", (0.0, 0.0, TOP + 0.02)),
            [],
            (None, "table1", "kitchen1"),
            id="let go a little above",
        ),
        pytest.param(thing("cup1", (0.0, 0.0, TOP + 0.2)), [], (None, None, "kitchen1"), id="in the air"),
        pytest.param(thing("cup1", (0.0, 0.0, 0.0)), [], (None, None, "kitchen1"), id="under the table"),
        pytest.param(thing("cup1", (1.5, 0.0, TOP)), [], (None, None, "kitchen1"), id="beside the table"),
        pytest.param(
            thing("cup1", (0.4, 0.0, TOP)), [], (None, "table1", "kitchen1"), id="half over the edge"
        ),
        pytest.param(
            thing("cup1", (0.0, 0.3, TOP + BOOK.size_m[2])),
            [BOOK],
            (None, "book1", "kitchen1"),
            id="on a book",
        ),
        pytest.param(
            thing("apple1", (0.1, 0.0, TOP + 0.02)), [BOWL], ("bowl1", None, "kitchen1"), id="in a bowl"
        ),
        pytest.param(thing("bowl1", (0.1, 0.0, TOP)), [], (None, "table1", "kitchen1"), id="the bowl itself"),
        pytest.param(
            thing("bottle1", (0.0, 0.0, TOP), turn=LYING),
            [],
            (None, "table1", "kitchen1"),
            id="lying on its side",
        ),
        *(
            pytest.param(
                thing("book2", (2.0, 0.0, board)), [SHELF], (None, "bookshelf1", "kitchen1"), id=f"board {n}"
            )
            for n, board in enumerate(BOARDS)
        ),
        pytest.param(
            thing("cup1", (-2.0, 0.0, shapes()["chair"].surfaces[-1].height)),
            [thing("chair1", (-2.0, 0.0, 0.0))],
            (None, "chair1", "kitchen1"),
            id="on a chair's seat",
        ),
        pytest.param(
            thing("lamp1", (2.0, 2.0, 0.0)), [], (None, None, "corner1"), id="in a corner of a room"
        ),
        pytest.param(thing("lamp1", (9.0, 2.0, 0.0)), [], (None, None, None), id="outside"),
        pytest.param(
            thing("thing1", (0.0, 0.0, TOP), model="unheard of"),
            [],
            (None, None, "kitchen1"),
            id="without a size",
        ),
    ],
)
def test_spatial_relations(entity, others, expected):
    assert said(entity.name, entity, *others) == expected


def test_an_entity_without_a_position_has_no_relations():
    space = Space([TABLE, thing("cup1", None)])
    assert list(space.solids) == ["table1"]


def test_an_overturned_table_supports_nothing():
    over = thing("table2", (2.5, 0.0, TOP), turn=(0.0, 1.0, 0.0, 0.0), model="table")
    assert said("cup1", over, thing("cup1", (2.5, 0.0, TOP)))[1] is None


def test_a_model_is_turned_as_in_the_simulator():
    x, y, z = TABLE.size_m
    desk = thing("table2", (-2.0, 0.0, 0.0), model="table", size=(y, x, z))
    assert said("cup1", desk, thing("cup1", (-2.0 + 0.4 * y, 0.0, z)))[1] == "table2"


def test_equal_positions_and_zero_sizes_are_accepted():
    twice = [thing("cup1", (0.0, 0.0, TOP)), thing("cup2", (0.0, 0.0, TOP))]
    assert said("cup1", *twice)[1] == "table1"


POSES = st.tuples(st.floats(-3, 3), st.floats(-3, 3), st.sampled_from([0.0, TOP, 0.3]), st.floats(-4, 4))
NAMES = st.sampled_from(["cup1", "table2", "bowl1", "book1", "chair1", "corner1"])


@given(st.lists(st.tuples(NAMES, st.none() | POSES), max_size=25))
def test_updating_a_space_equals_rebuilding_it(changes):
    there = {entity.name: entity for entity in (ROOM, TABLE)}
    kept = LazySpace(lambda: list(there.values()), there.get)
    kept.space()
    for name, pose in changes:
        if pose is None:
            there.pop(name, None)
        else:
            x, y, z, yaw = pose
            place = name == "corner1"
            there[name] = thing(
                name, (x, y, z), yaw=yaw, place=place, size=(1.5, 1.5, 2.5) if place else None
            )
        kept.mark_changed([name])
    new, space = Space(there.values()), kept.space()
    assert space.solids.keys() == new.solids.keys()
    for name, solid in space.solids.items():
        ours, theirs = space.spatial_relations(solid), new.spatial_relations(new.solids[name])
        assert named(ours) == named(theirs)


def named(found):
    container, supports, place = found
    return [f and (f[0].name, f[1]) for f in (container, *supports, place)]


def tilted(degrees):
    half = math.radians(degrees) / 2
    return (math.cos(half), 0.0, math.sin(half), 0.0)


def boards(degrees=50.0, height=1.0):
    """Return two boards, one metre wide, that meet in a valley at x = 0."""
    x, z = 0.5 * math.cos(math.radians(degrees)), 0.5 * math.sin(math.radians(degrees))
    size = (1.0, 1.0, 0.02)
    return [
        thing("board1", (-x, 0.0, height + z), "box", turn=tilted(degrees), size=size),
        thing("board2", (x, 0.0, height + z), "box", turn=tilted(-degrees), size=size),
    ]


def test_an_object_held_by_steep_sides_is_on_them():
    ball = thing("ball1", (0.0, 0.0, 1.09))
    space = Space([ROOM, *boards(), ball])
    supports = space.spatial_relations(space.solids["ball1"]).supports
    assert [(side.name, made.holds, made.share) for side, made in supports] == [
        ("board1", True, 0.0),
        ("board2", True, 0.0),
    ]


def test_a_leaning_object_on_the_floor_has_no_support():
    low = boards(height=0.0)
    for there in ([ROOM, *low], low):  # also where no floor is known
        space = Space([*there, thing("ball1", (-0.235, 0.0, 0.0))])
        assert space.spatial_relations(space.solids["ball1"]).supports == ()


@given(
    st.lists(st.tuples(st.floats(-3, 3), st.floats(-3, 3)), max_size=12),
    st.lists(st.sampled_from([0.0, 0.01, 0.02, 0.5]), min_size=3, max_size=3),
)
def test_cached_neighbours_equal_uncached_ones(places, margins):
    space = Space([ROOM, TABLE, *(thing(f"cup{k}", (x, y, TOP)) for k, (x, y) in enumerate(places))])
    for solid in space.solids.values():
        expected = [set(space.around(solid, margin)) for margin in margins]
        with space.caching(of_few=True):
            assert [set(space.around(solid, margin)) for margin in margins] == expected
            assert set(space.supporters_around(solid)) == set(space.grid.around(solid.bounds, 0.0, solid))
    assert space.cache is None


@pytest.mark.parametrize(
    ("support", "solid", "expected"),
    [
        pytest.param(TABLE, thing("cup1", (0.0, 0.0, TOP)), True, id="on it"),
        pytest.param(TABLE, thing("cup1", (0.0, 0.0, TOP + 0.3)), False, id="in the air"),
        pytest.param(TABLE, thing("cup1", (0.0, 0.0, 0.0)), False, id="under it"),
        pytest.param(TABLE, thing("cup1", (2.0, 0.0, TOP)), False, id="beside it"),
        pytest.param(BOWL, thing("apple1", (0.1, 0.0, TOP + 0.02)), True, id="in it"),
        pytest.param(TABLE, CORNER, False, id="a place"),
    ],
)
def test_an_object_may_support_what_is_on_or_inside_it(support, solid, expected):
    space = Space([ROOM, support, solid])
    assert space.may_support(space.solids[support.name], space.solids[solid.name]) == expected


def test_what_is_attached_is_supported_only_by_what_is_carried_with_it():
    def attached(entity, holder):
        return structs.replace(entity, properties={IS_GRASPED_BY: holder}, grip_provenance=PROVENANCE)

    tray = attached(thing("tray1", (0.0, 0.0, TOP)), "robot1")
    cup = attached(thing("cup1", (0.0, 0.0, TOP + 0.03)), "tray1")
    other = attached(thing("cup2", (0.1, 0.1, TOP + 0.03)), "robot1")
    space = Space([ROOM, TABLE, tray, cup, other])
    of = space.solids
    assert space.holders == {"tray1": "robot1", "cup1": "tray1", "cup2": "robot1"}
    assert space.may_support(of["tray1"], of["cup1"])
    assert not space.may_support(of["table1"], of["tray1"])
    assert not space.may_support(of["tray1"], of["cup2"])


def block(name, z, height=0.2, width=0.2, x=0.0, *, fixed=False):
    return structs.replace(thing(name, (x, 0.0, z), "", size=(width, 0.2, height)), fixed=fixed)


BASE = block("base1", 0.0, 0.7, 1.0)
WALL = block("wall1", 0.0, 2.5, 0.1, x=0.155)
HANGING = block("board1", 1.0, 0.7, 1.0)


@pytest.mark.parametrize(
    ("z", "others", "loose", "fixed"),
    [
        pytest.param(0.7, [BASE], ["base1"], ["base1"], id="on what stands"),
        pytest.param(0.73, [BASE], ["base1"], [], id="a little above"),
        pytest.param(0.7, [BASE, WALL], ["base1"], [], id="at a wall"),
        pytest.param(0.7, [BASE, block("shelf1", 0.7, x=0.21)], ["base1"], ["base1"], id="beside a thing"),
        pytest.param(
            0.7, [BASE, block("shelf1", 0.6, x=0.21, fixed=True)], ["base1"], [], id="beside a fixture"
        ),
        pytest.param(2.3, [block("base1", 0.0, 2.3, 1.0)], ["base1"], [], id="at the ceiling"),
        pytest.param(1.7, [HANGING], ["board1"], [], id="on what hangs"),
        pytest.param(1.7, [structs.replace(HANGING, fixed=True)], ["board1"], ["board1"], id="on a fixture"),
    ],
)
def test_a_fixed_object_is_held_by_wall_or_ceiling_or_is_on_what_stands_or_is_fixed(z, others, loose, fixed):
    for is_fixed, expected in ((False, loose), (True, fixed)):
        space = Space([ROOM, *others, block("a1", z, fixed=is_fixed)])
        supports = space.spatial_relations(space.solids["a1"]).supports
        assert [support.name for support, _ in supports] == expected


@pytest.mark.parametrize(
    ("other", "loose", "fixed"),
    [
        pytest.param(WALL, True, True, id="a wall"),
        pytest.param(HANGING, True, False, id="what hangs"),
        pytest.param(structs.replace(HANGING, fixed=True), True, True, id="a fixture"),
    ],
)
def test_a_fixed_object_hangs_on_nothing_that_hangs_itself(other, loose, fixed):
    for is_fixed, expected in ((False, loose), (True, fixed)):
        for places in ([ROOM], []):
            space = Space([*places, other, block("a1", 1.2, fixed=is_fixed)])
            solid, of = space.solids["a1"], space.solids[other.name]
            assert space.may_hold(of, solid) == (expected or not places)


@pytest.mark.parametrize(
    ("bottom", "others", "expected"),
    [
        pytest.param(0.7, [BASE, block("low1", 0.0, 0.5, 0.5)], ["base1"], id="the nearest"),
        pytest.param(
            0.7,
            [block("left1", 0.0, 0.7, 0.3, x=-0.2), block("right1", 0.0, 0.7, 0.2, x=0.15)],
            ["right1", "left1"],
            id="two at one height, the one with the greater share first",
        ),
        pytest.param(
            0.7,
            [block("left1", 0.0, 0.7, 0.2, x=-0.1), block("right1", 0.0, 0.66, 0.2, x=0.1)],
            ["left1"],
            id="the higher of two",
        ),
        pytest.param(0.01, [block("rug1", 0.0, 0.005, 1.0)], ["rug1"], id="what lies on the floor"),
        pytest.param(0.0, [block("rug1", 0.0, 0.005, 1.0)], [], id="on the floor through a rug"),
        pytest.param(0.7, [block("edge1", 0.0, 0.7, 0.2, x=0.19)], [], id="over an edge"),
    ],
)
def test_the_supports_of_an_object(bottom, others, expected):
    space = Space([ROOM, *others, block("a1", bottom)])
    supports = space.spatial_relations(space.solids["a1"]).supports
    assert [support.name for support, _ in supports] == expected


def test_changes_for_a_while_leave_no_trace():
    held = structs.replace(
        thing("cup1", (0.0, 0.0, TOP)), properties={IS_GRASPED_BY: "robot1"}, grip_provenance=PROVENANCE
    )
    space = Space([ROOM, TABLE, held, BOOK])
    solids, holders = dict(space.solids), dict(space.holders)
    moved = thing("book1", (2.0, 2.0, 0.0))
    with (
        suppress(ZeroDivisionError),
        space.with_changes(
            [moved, thing("cup1", (0.1, 0.0, TOP)), thing("new1", (0.0, 0.0, 0.0))],
            without=["table1", "missing"],
        ),
    ):
        assert space.solids.keys() == {"kitchen1", "cup1", "book1", "new1"}
        assert space.solids["book1"].position == (2.0, 2.0, 0.0)
        assert space.holders == {}
        raise ZeroDivisionError
    assert space.solids == solids
    assert space.holders == holders == {"cup1": "robot1"}
    assert set(space.find_within(solids["kitchen1"].bounds)) == set(solids.values())
    assert not space.is_flat
