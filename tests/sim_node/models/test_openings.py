"""Models that open, in the simulator, with contents."""

import math

import pytest

from semmap.nodes.sim_node.models import openings
from semmap.nodes.sim_node.models.forms import WHITE
from semmap.nodes.sim_node.models.library import build
from semmap.nodes.sim_node.models.parts import bounds, box, moved
from semmap.nodes.sim_node.models.variety_table import KINDS
from semmap.nodes.sim_node.world import World
from semmap.schemas.scenes import JointOrder
from tests.sim_node.models.known_models import differences
from tests.sim_node.orders import bodies, order, pose, spawned

OPENING = {
    "door": {"leaf"},
    "fridge": {"door", "freezer"},
    "oven": {"door"},
    "microwave": {"door"},
    "dishwasher": {"door"},
    "washing_machine": {"door"},
    "cabinet": {"left", "right"},
    "cupboard": {"left", "right", "upper_left", "upper_right"},
    "wardrobe": {"left", "right"},
    "drawer": {"drawer_1", "drawer_2", "drawer_3", "drawer_4"},
    "desk": {"drawer_1", "drawer_2", "drawer_3"},
    "laptop": {"lid"},
    "suitcase": {"lid"},
    "bin": {"lid"},
    "cardboard_box": {"left", "right"},
    "small_carton": {"left", "right"},
    "flat_carton": {"left", "right"},
    "upright_carton": {"left", "right"},
}


def test_these_models_open():
    found = {name: {leaf.joint.name for leaf in build(name, None).leaves} for name in KINDS}
    assert {name: joints for name, joints in found.items() if joints} == OPENING


@pytest.mark.parametrize("model", OPENING)
def test_it_opens_and_shuts_stays_so_and_sleeps(model):
    world = spawned(order("it", model, pose(0.0, 0.0), fixed=model == "door"))
    world.step(1.0)
    before = bodies(world)["it"].pose
    for share in (1.0, 0.5, 0.0):
        assert world.move_joints([JointOrder(name="it", openness=share)]).failed == {}
        world.step(5.0)
        it = bodies(world)["it"]
        assert [joint.openness for joint in it.joints] == pytest.approx([share] * len(it.joints), abs=0.03)
        assert it.resting
        assert world.asleep
        assert it.pose.position_m == pytest.approx(before.position_m, abs=0.03)


@pytest.mark.parametrize("size_m", [(0.6, 1.5, 0.9), (1.5, 0.6, 0.9), (0.3, 0.3, 0.3)])
def test_its_joints_are_as_large_as_it_is_and_turn_with_it(size_m):
    world = World()
    world.spawn([order("it", "drawer", pose(0.0, 0.0, yaw=1.0), size_m=size_m)])
    world.step(1.0)
    world.move_joints([JointOrder(name="it", openness=1.0, joint="drawer_1")])
    world.step(4.0)
    assert bodies(world)["it"].joints[-1].openness == pytest.approx(1.0, abs=0.02)


def test_what_is_in_a_drawer_moves_with_it():
    chest = build("drawer", None)
    (top,) = (leaf for leaf in chest.leaves if leaf.joint.name == "drawer_1")
    x, y, z = top.parts[0].centre
    world = spawned(order("chest", "drawer", pose(0.0, 0.0)))
    world.spawn([order("apple1", "apple", pose(x, y, z + 0.01))])
    world.step(2.0)
    before = bodies(world)["apple1"].pose.position_m
    world.move_joints([JointOrder(name="chest", joint="drawer_1", openness=1.0)])
    world.step(4.0)
    after, travel = bodies(world)["apple1"].pose.position_m, top.joint.range[1]
    assert after[0] - before[0] == pytest.approx(travel, abs=0.12)
    assert after[2] == pytest.approx(before[2], abs=0.02)
    assert bodies(world)["apple1"].resting


def test_milk_stays_in_the_fridge_while_its_door_opens_and_shuts():
    world = spawned(
        order("fridge1", "fridge", pose(0.0, 0.0)), order("milk1", "carton", pose(-0.1, 0.0, 0.9))
    )
    world.step(2.0)
    before = bodies(world)["milk1"].pose.position_m
    for share in (1.0, 0.0):
        world.move_joints([JointOrder(name="fridge1", openness=share)])
        world.step(4.0)
    assert bodies(world)["milk1"].pose.position_m == pytest.approx(before, abs=0.02)


@pytest.mark.parametrize(
    ("model", "at"),
    [("bin", (0.05, 0.0, 0.02)), ("cardboard_box", (0.0, 0.0, 0.02)), ("suitcase", (-0.03, 0.0, 0.07))],
)
def test_what_is_put_in_stays_there_while_it_opens_and_shuts(model, at):
    world = spawned(order("it", model, pose(0.0, 0.0)))
    world.spawn([order("apple1", "apple", pose(*at), size_m=(0.06, 0.06, 0.06))])
    world.step(2.0)
    before = bodies(world)["apple1"].pose.position_m
    for share in (1.0, 0.0):
        world.move_joints([JointOrder(name="it", openness=share)])
        world.step(5.0)
        found = bodies(world)
        assert [j.openness for j in found["it"].joints] == pytest.approx(
            [share] * len(found["it"].joints), abs=0.02
        )
        assert found["apple1"].pose.position_m == pytest.approx(before, abs=0.03)


def test_what_is_put_on_a_shut_box_does_not_press_its_flaps_in():
    world = spawned(order("box1", "cardboard_box", pose(0.0, 0.0)))
    world.spawn([order(f"book{k}", "book", pose(0.0, 0.0, 0.31 + 0.04 * k), size_m=None) for k in range(5)])
    world.step(5.0)
    top = bodies(world)["box1"].size_m[2]
    assert bodies(world)["book0"].pose.position_m[2] == pytest.approx(top, abs=0.01)
    assert [joint.openness for joint in bodies(world)["box1"].joints] == pytest.approx([0.0, 0.0], abs=0.02)
    assert all(body.resting for body in bodies(world).values())


@pytest.mark.parametrize("model", OPENING)
def test_it_opens_as_the_knowledge_base_knows_it(model):
    assert differences(model) == []


def test_a_cabinet_is_open_at_its_front_and_has_boards_that_reach_from_the_back():
    parts = openings.cabinet_box((0.8, 1.0, 2.0), (0.1, 0.2, 1.0), WHITE, boards=(0.25,), depth=0.5)
    low, high = bounds(parts)
    assert (low.tolist(), high.tolist()) == (pytest.approx([-0.3, -0.3, 0.0]), pytest.approx([0.5, 0.7, 2.0]))
    assert len(parts) == 6
    assert not any(bounds([part])[0][0] > 0.4 for part in parts)  # nothing closes the front
    low, high = bounds(parts[-1:])
    assert (low[0], high[0]) == pytest.approx((-0.3 + 0.02, -0.3 + 0.5 * 0.78))
    assert (low[2] + high[2]) / 2 == pytest.approx(0.5)
    assert high[1] - low[1] == pytest.approx(0.96)
    volume = sum(part.volume for part in parts[:-1])
    assert volume == pytest.approx(0.8 * 1.0 * 2.0 - 0.78 * 0.96 * 1.96)


def test_the_inside_of_a_cabinet_is_a_little_darker_or_of_another_colour():
    board = openings.cabinet_box((0.8, 1.0, 2.0), (0, 0, 1), (0.5, 0.5, 0.5), boards=(0.5,))[-1]
    assert board.colour == pytest.approx((0.46, 0.46, 0.46))
    lined = openings.cabinet_box((0.8, 1.0, 2.0), (0, 0, 1), WHITE, boards=(0.5,), lining=(0.1, 0.2, 0.3))
    assert lined[-1].colour == (0.1, 0.2, 0.3)


def test_a_frame_leaves_its_hole_free():
    size, hole = (0.8, 1.0, 2.0), (-0.3, 0.3, 0.5, 1.5)
    plain = openings.cabinet_box(size, (0.0, 0.0, 1.0), WHITE)
    framed = openings.framed_box(size, (0.0, 0.0, 1.0), WHITE, hole)
    front = framed[len(plain) :]
    assert len(front) == 4
    low, high = bounds(front)
    assert (low.tolist(), high.tolist()) == (
        pytest.approx([0.38, -0.5, 0.0]),
        pytest.approx([0.4, 0.5, 2.0]),
    )
    assert sum(part.volume for part in front) == pytest.approx(0.02 * (1.0 * 2.0 - 0.6 * 1.0))
    for part in front:
        low, high = bounds([part])
        assert high[1] <= -0.3 + 1e-9 or low[1] >= 0.3 - 1e-9 or high[2] <= 0.5 + 1e-9 or low[2] >= 1.5 - 1e-9
    wide = openings.framed_box(size, (0.0, 0.0, 1.0), WHITE, (-0.5, 0.5, 0.5, 2.0))
    assert len(wide) == len(plain) + 1  # no strips of no width


def test_walls_are_thicker_of_what_is_larger_and_thinner_of_what_is_small():
    assert openings.wall_of((0.8, 1.0, 2.0)) == 0.02
    assert openings.wall_of((1.0, 2.0, 2.0)) == openings.wall_of((2.0, 1.0, 2.0)) == pytest.approx(0.036)
    assert openings.wall_of((0.1, 1.0, 2.0)) == pytest.approx(0.01)


def test_a_drawer_is_a_tray_behind_a_panel_that_slides_out():
    parts = openings.pull_out("d", (0.4, 0.6, 0.2), (0.1, 0.2, 0.3), (0.5, 0.5, 0.5), panel=(0.7, 0.25))
    joint = parts[0].joint
    assert all(part.joint == joint for part in parts)
    assert (joint.kind, joint.axis, joint.anchor) == ("slide", (1.0, 0.0, 0.0), (0.1, 0.2, 0.3))
    assert joint.range == pytest.approx((0.0, 0.26))
    assert (joint.closed, joint.friction) == (0.0, 3.0)
    low, high = bounds(parts[:4])
    assert (low.tolist(), high.tolist()) == (
        pytest.approx([-0.1, -0.1, 0.2]),
        pytest.approx([0.3, 0.5, 0.4]),
    )
    low, high = bounds(parts[4:])
    assert (low.tolist(), high.tolist()) == (
        pytest.approx([0.3, -0.15, 0.175]),
        pytest.approx([0.312, 0.55, 0.425]),
    )
    walls = 0.4 * 0.6 * 0.008 + 0.192 * 0.008 * (0.6 + 2 * 0.392)
    assert sum(part.volume for part in parts[:4]) == pytest.approx(walls)
    assert (parts[0].colour, parts[4].colour) == (pytest.approx((0.4,) * 3), pytest.approx((0.6,) * 3))


@pytest.mark.parametrize("hinge", [1, -1])
def test_a_door_turns_about_its_outer_edge(hinge):
    (leaf,) = openings.side_door("d", (0.02, 0.6, 2.0), (0.3, 0.1, 1.0), WHITE, hinge=hinge)
    joint = leaf.joint
    assert joint.anchor == pytest.approx((0.31, 0.1 + hinge * 0.3, 1.0))
    assert joint.axis == (0.0, 0.0, float(hinge))
    assert joint.range == pytest.approx((0.0, math.radians(100.0)))
    opened = moved(leaf, math.pi / 2)
    assert bounds([opened])[0][0] >= 0.3  # outwards


def test_a_flap_tips_forwards_about_its_lower_edge():
    (leaf,) = openings.flap("d", box((0.02, 0.6, 0.5), (0.3, 0.0, 0.25), WHITE), (0.3, 0.0, 0.0))
    assert leaf.joint.range == pytest.approx((0.0, math.pi / 2))
    low, high = bounds([moved(leaf, math.pi / 2)])
    assert (low[0], high[0], high[2]) == pytest.approx((0.3, 0.8, 0.01))
