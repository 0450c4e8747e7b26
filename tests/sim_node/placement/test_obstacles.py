"""Overlap and support of boxes of known sizes in a static scene."""

import mujoco
import numpy as np
import pytest

from semmap.nodes.sim_node.body_classes import BodyClasses
from semmap.nodes.sim_node.models.library import build
from semmap.nodes.sim_node.order_validation import validate_spawn
from semmap.nodes.sim_node.placement.obstacles import GROUND
from semmap.nodes.sim_node.world import World
from tests.household import household_classes
from tests.sim_node.orders import order, pose

BOX = (0.4, 0.4, 0.4)


def obstacles(*orders, **records):
    """Return a scene of boxes, by name: `(x, y, z)` and size; nothing has moved."""
    engine = World()._engine
    made = [
        order(name, "", pose(*at), size_m=size_m, fixed=bool(fixed)) for name, (at, size_m, *fixed) in orders
    ]
    accepted, failed = validate_spawn(made, build, lambda name: False)
    assert failed == {}
    for name, changes in records.items():
        for key, value in changes.items():
            setattr(accepted[name][0], key, value)
    engine.add(list(accepted.values()))
    return engine.obstacles(), engine.index.row


def test_boxes_of_bodies_are_those_of_their_geometry():
    here, row = obstacles(("a", ((1.0, 2.0, 0.5), (0.4, 0.6, 0.8))), ("b", ((5.0, 0.0, 0.0), BOX)))
    assert here.body_low[row["a"]] == pytest.approx((0.8, 1.7, 0.5))
    assert here.body_high[row["a"]] == pytest.approx((1.2, 2.3, 1.3))
    assert here.footprint[row["a"]] == pytest.approx((0.4, 0.6))
    assert here.volume[row["a"]] == pytest.approx(0.4 * 0.6 * 0.8)
    assert here.body_low[row["b"]] == pytest.approx((4.8, -0.2, 0.0))


@pytest.mark.parametrize(
    ("x", "hits"), [(0.39, True), (0.398, False), (0.5, False), (-0.39, True), (-0.398, False)]
)
def test_bodies_hit_one_another_when_they_overlap_by_more_than_a_little(x, hits):
    here, row = obstacles(("a", ((0.0, 0.0, 0.1), BOX)), ("b", ((x, 0.0, 0.1), BOX)))
    assert here.hits(row["a"]) == ([row["b"]] if hits else [])
    assert here.hits(row["b"]) == ([row["a"]] if hits else [])


def test_how_deep_they_may_overlap_can_be_asked_for():
    here, row = obstacles(("a", ((0.0, 0.0, 0.1), BOX)), ("b", ((0.39, 0.0, 0.1), BOX)))
    assert here.hits(row["a"], 0.02) == []
    assert here.hits(row["a"], 0.0005) == [row["b"]]


@pytest.mark.parametrize(("z", "hits"), [(-0.1, True), (-0.003, False), (0.0, False)])
def test_what_is_in_the_floor_hits_the_ground(z, hits):
    here, row = obstacles(("a", ((0.0, 0.0, z), BOX)))
    assert here.hits(row["a"]) == ([GROUND] if hits else [])


def test_what_is_fixed_hits_neither_the_ground_nor_what_is_fixed():
    here, row = obstacles(
        ("a", ((0.0, 0.0, -0.1), BOX, "fixed")),
        ("b", ((0.1, 0.0, 0.0), BOX, "fixed")),
        ("c", ((-0.1, 0.0, 0.0), BOX)),
    )
    assert here.hits(row["a"]) == [row["c"]]
    assert here.is_fixed(row["a"])
    assert not here.is_fixed(row["c"])


def test_ghosts_and_what_is_held_are_in_nobody_s_way():
    here, row = obstacles(
        ("a", ((0.0, 0.0, 0.1), BOX)),
        ("b", ((0.1, 0.0, 0.1), BOX)),
        ("c", ((0.0, 0.1, 0.1), BOX)),
        b={"ghost": True},
        c={"held_by": "a"},
    )
    assert here.standing[[row["a"], row["b"], row["c"]]].tolist() == [True, False, False]
    assert here.hits(row["a"]) == []
    assert here.hits(row["b"]) == [row["a"]]  # a ghost feels what it stands in all the same


@pytest.mark.parametrize(
    ("margin_m", "touched"), [(0.05, {"a"}), (0.15, {"a", "b"}), (0.35, {"a", "b", "c"})]
)
def test_bodies_within_a_margin_are_touched(margin_m, touched):
    here, row = obstacles(
        ("a", ((0.0, 0.0, 0.0), BOX)),
        ("b", ((0.5, 0.0, 0.0), BOX)),
        ("c", ((0.0, 0.0, 0.7), BOX)),
        ("d", ((9.0, 0.0, 0.0), BOX)),
    )
    assert here.touched(row["a"], margin_m) == sorted(row[name] for name in touched)


def test_a_body_that_is_raised_is_out_of_the_way():
    here, row = obstacles(("a", ((0.0, 0.0, 0.0), BOX)), ("b", ((0.0, 0.0, 0.1), BOX)))
    assert here.hits(row["b"]) == [row["a"]]
    here.raise_(row["b"], 0.31)
    assert here.body_low[row["b"], 2] == pytest.approx(0.41)
    assert here.body_high[row["b"], 2] == pytest.approx(0.81)
    assert here.hits(row["b"]) == []
    assert here.hits(row["a"]) == []
    here.raise_(row["b"], -0.31)
    assert here.hits(row["a"]) == [row["b"]]


@pytest.mark.parametrize(
    ("size_m", "carried"),
    [
        ((0.3, 0.3, 0.2), True),
        ((0.41, 0.41, 0.2), True),  # a little wider
        ((0.43, 0.43, 0.2), False),
        ((0.1, 0.1, 0.3), True),  # tall, but much smaller
        ((0.2, 0.2, 0.9), False),  # tall, and not much smaller
        ((0.3, 0.3, 0.44), True),  # squat
        ((0.3, 0.3, 0.46), False),
    ],
)
def test_what_fits_and_is_small_or_squat_is_carried(size_m, carried):
    here, row = obstacles(("a", ((0.0, 0.0, 0.0), BOX)), ("b", ((3.0, 0.0, 0.0), size_m)))
    assert here.carries(row["a"], row["b"]) is carried


def test_what_is_long_is_carried_by_what_is_long_the_other_way():
    here, row = obstacles(
        ("a", ((0.0, 0.0, 0.0), (0.4, 1.0, 0.4))), ("b", ((3.0, 0.0, 0.0), (0.9, 0.3, 0.1)))
    )
    assert here.carries(row["a"], row["b"])
    assert not here.carries(row["b"], row["a"])


@pytest.mark.parametrize(
    ("at", "shares"),
    [((0.0, 0.0, 0.0), True), ((0.015, -0.015, 0.015), True), ((0.03, 0.0, 0.0), False)],
    ids=["the same", "nearly", "beside"],
)
def test_a_cup_at_the_very_spot_of_a_table_is_meant_to_be_on_it(at, shares):
    here, row = obstacles(("table", ((0.0, 0.0, 0.0), (0.8, 0.8, 0.7))), ("cup", (at, (0.1, 0.1, 0.1))))
    assert here.shared_spot(row["cup"]) == ([row["table"]] if shares else [])
    assert here.small_at_spot(row["table"]) == ([row["cup"]] if shares else [])
    assert here.shared_spot(row["table"]) == here.small_at_spot(row["cup"]) == []


@pytest.mark.parametrize(
    ("table", "cup"),
    [
        (((0.0, 0.0, 0.0), (0.8, 0.8, 0.15)), ((0.0, 0.0, 0.0), (0.1, 0.1, 0.1))),
        (((0.0, 0.0, 0.0), (0.8, 0.8, 0.7)), ((0.0, 0.0, 0.0), (0.1, 0.1, 0.1), "fixed")),
        (((0.0, 0.0, 0.0), (0.8, 0.8, 0.7)), ((0.0, 0.0, 0.0), (0.5, 0.5, 0.5))),
        (((0.0, 0.0, 0.0), (0.8, 0.1, 0.7)), ((0.0, 0.0, 0.0), (0.2, 0.2, 0.1))),
    ],
    ids=["a low thing", "what is fixed", "what is not much smaller", "what is too wide"],
)
def test_this_does_not_belong_on_what_is_at_its_spot(table, cup):
    here, row = obstacles(("table", table), ("cup", cup))
    assert here.shared_spot(row["cup"]) == []


def test_surfaces_under_the_middle_of_a_body_come_lowest_first():
    here, row = obstacles(
        ("low", ((0.0, 0.0, 0.0), (1.0, 1.0, 0.3))),
        ("high", ((0.2, 0.0, 0.5), (1.0, 1.0, 0.4))),
        ("aside", ((2.0, 0.0, 0.0), (1.0, 1.0, 0.6))),
        ("thing", ((0.1, 0.1, 0.1), (0.1, 0.1, 0.1))),
    )
    found = here.surfaces(row["thing"])
    assert [owner for _, owner in found] == [row["low"], row["high"]]
    assert [top for top, _ in found] == pytest.approx([0.3, 0.9])


def test_a_surface_lower_than_a_body_s_bottom_is_none_for_it_and_the_floor_is_one_for_what_is_below():
    here, row = obstacles(
        ("low", ((0.0, 0.0, 0.0), (1.0, 1.0, 0.3))),
        ("above", ((0.0, 0.0, 0.5), (0.1, 0.1, 0.1))),
        ("below", ((3.0, 0.0, -0.5), (0.1, 0.1, 0.1))),
    )
    assert here.surfaces(row["above"]) == []
    assert here.surfaces(row["below"]) == [(0.0, GROUND)]


def test_surfaces_of_what_does_not_stand_or_could_not_carry_it_do_not_count():
    here, row = obstacles(
        ("ghost", ((0.0, 0.0, 0.0), (1.0, 1.0, 0.3))),
        ("small", ((0.0, 0.0, 0.5), (0.05, 0.05, 0.4))),
        ("thing", ((0.0, 0.0, 0.0), (0.1, 0.1, 0.1))),
        ghost={"ghost": True},
    )
    assert here.surfaces(row["thing"]) == []


def test_rows_are_those_of_the_index_whatever_the_order_of_geometry():
    here, row = obstacles(*((f"b{i}", ((float(i), 0.0, 0.0), BOX)) for i in range(6)))
    assert [here.body_low[row[f"b{i}"], 0] for i in range(6)] == pytest.approx(np.arange(6) - 0.2)


@pytest.mark.parametrize(
    ("masks", "has_box"), [((1, 1), True), ((1, 0), True), ((0, 1), True), ((0, 0), False)]
)
def test_a_ghost_has_the_box_of_its_geometry_that_would_collide(masks, has_box):
    """Geometry of a world file may collide in one direction only."""
    here, row = obstacles(("a", ((1.0, 2.0, 0.5), BOX)), a={"ghost": True, "masks": [masks]})
    assert np.isfinite(here.body_low[row["a"]]).all() == has_box
    assert not here.standing[row["a"]]


TABLE_WITH_A_BOOK = """<mujoco><worldbody><geom type="plane" size="0 0 .1"/>
<body name="table1" pos="0 0 .35"><freejoint/><geom type="box" size=".6 .4 .35"/>
  <body name="book1" pos=".2 0 .36"><geom type="box" size=".1 .08 .01"/></body>
</body>
<body name="tray1" pos=".2 0 .715"><freejoint/><geom type="box" size=".2 .2 .01"/></body>
<body name="cup1" pos=".2 0 .74"><freejoint/><geom type="cylinder" size=".04 .04"/></body>
</worldbody></mujoco>"""


def test_a_part_that_is_a_body_is_an_obstacle_of_its_own_and_moves_with_the_whole():
    world = World(mujoco.MjSpec.from_string(TABLE_WITH_A_BOOK), classes=BodyClasses(household_classes()))
    engine = world._engine
    mujoco.mj_kinematics(engine.model, engine.data)
    here, row = engine.obstacles(), engine.index.row
    table, book, tray, cup = (row[name] for name in ("table1", "book1", "tray1", "cup1"))
    assert here.body_high[table, 2] == pytest.approx(0.72)
    assert here.hits(tray) == [book, cup]
    assert here.hits(table) == [tray, cup]  # with the book, not into it
    assert [owner for _, owner in here.surfaces(cup)] == [book, tray]
    assert here.carries(table, tray)
    assert not here.carries(book, tray)  # which is larger
    here.raise_(table, 1.0)
    assert here.body_low[book, 2] == pytest.approx(1.7)
    assert here.hits(tray) == [cup]
    here.raise_(table, -1.0)
    here.standing[table] = False
    assert here.hits(tray) == [cup]
