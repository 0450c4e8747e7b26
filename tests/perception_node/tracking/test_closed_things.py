"""Contents of a closed fridge stay in the map; things missing from an open one are removed."""

from __future__ import annotations

import numpy as np
import pytest

from semmap.nodes.perception_node.input.projection import cloud_of
from semmap.nodes.perception_node.tracking.occupancy import occupancy_in
from semmap.nodes.sim_node.vision.raycast import raycast
from semmap.nodes.sim_node.vision.view import look_at
from semmap.nodes.sim_node.world import World
from semmap.schemas.commands import Remove
from semmap.schemas.entities import Pose
from semmap.schemas.scenes import BodyOrder, JointOrder
from tests.perception_node.things import CONFIG, Table, entity
from tests.sim_node.orders import bodies

ORIGIN = Pose(position_m=(0.0, 0.0, 0.0))
MILK_M = (0.08, 0.08, 0.2)


class LooksAt(Table):
    """A map whose occupancy comes from a depth image, without observations."""

    def _occupancy(self, pose, size_m):
        return self.occupancy(pose, size_m)


def kitchen():
    """Return a fridge at the origin, with its door open and milk on a board in it."""
    world = World()
    world.spawn(
        [BodyOrder(name="fridge1", class_="Fridge", model="fridge", pose=ORIGIN, fixed=True, commit=1)]
    )
    swing(world, 1.0)
    carton = Pose(position_m=(-0.05, 0.0, 0.75))
    world.spawn([BodyOrder(name="milk1", class_="Milk", model="box", pose=carton, size_m=MILK_M, commit=1)])
    world.step(2.0)
    return world


def swing(world, to):
    world.move_joints([JointOrder(name="fridge1", openness=to)])
    world.step(3.0)


def occupancy(world):
    """Return what a camera before the fridge sees of places."""
    view = look_at(np.array([1.6, 0.1, 1.2]), np.array([0.0, 0.0, 0.85]), 320, 240, 1.0)
    _, depth, _ = raycast(world.model, world.data, view)
    intrinsics = np.asarray(view.intrinsics)
    return occupancy_in([cloud_of(depth, None, intrinsics, view.map_from_camera)])


def test_a_place_in_a_fridge_is_free_occupied_or_out_of_sight():
    world = kitchen()
    milk = world.pose("milk1")
    assert occupancy(world)(milk, MILK_M) == "occupied"
    swing(world, 0.0)
    assert occupancy(world)(milk, MILK_M) == "unknown"
    swing(world, 1.0)
    world.delete(["milk1"])
    assert occupancy(world)(milk, MILK_M) == "free"


@pytest.mark.parametrize(("door", "removed"), [(0.0, False), (1.0, True)])
def test_perception_removes_what_is_gone_only_where_it_can_look(door, removed):
    world = kitchen()
    milk = world.pose("milk1")
    world.delete(["milk1"])
    swing(world, door)
    table = LooksAt().told([entity("milk1", "Bottle", milk, MILK_M, source="perception")])
    table.occupancy = occupancy(world)
    commands = table.observe(3 * CONFIG.gone_frames)
    assert [type(command) for command in commands] == ([Remove] if removed else [])
    assert ("milk1" in table.entities) is not removed


TOY_M = (0.08, 0.08, 0.08)


def chest():
    """Return a chest at the origin with an open top drawer, and a toy in it."""
    world = World()
    world.spawn(
        [BodyOrder(name="chest1", class_="Drawer", model="drawer", pose=ORIGIN, fixed=True, commit=1)]
    )
    pull(world, 1.0)
    toy = Pose(position_m=(0.32, 0.0, 0.72))
    world.spawn([BodyOrder(name="toy1", class_="Object", model="box", pose=toy, size_m=TOY_M, commit=1)])
    world.step(2.0)
    return world


def pull(world, to):
    world.move_joints([JointOrder(name="chest1", joint="drawer_1", openness=to)])
    world.step(3.0)


def seen_from_above(world):
    """Return what a camera above the front of the chest sees of places."""
    view = look_at(np.array([1.0, 0.1, 1.8]), np.array([0.3, 0.0, 0.75]), 320, 240, 1.0)
    _, depth, _ = raycast(world.model, world.data, view)
    return occupancy_in([cloud_of(depth, None, np.asarray(view.intrinsics), view.map_from_camera)])


def test_a_place_in_a_drawer_is_out_of_sight_while_it_is_shut():
    world = chest()
    out = world.pose("toy1")
    assert seen_from_above(world)(out, TOY_M) == "occupied"
    pull(world, 0.0)
    shut_in = world.pose("toy1")
    assert shut_in.position_m[0] < out.position_m[0] - 0.15
    assert seen_from_above(world)(shut_in, TOY_M) == "unknown"
    world.delete(["toy1"])
    assert seen_from_above(world)(shut_in, TOY_M) == "unknown"
    pull(world, 1.0)
    assert seen_from_above(world)(out, TOY_M) == "free"


@pytest.mark.parametrize("drawer", [0.0, 1.0])
def test_perception_keeps_what_is_in_a_drawer_that_is_shut(drawer):
    world = chest()
    pull(world, 0.0)
    shut_in = world.pose("toy1")
    world.delete(["toy1"])
    table = LooksAt().told([entity("toy1", "Bottle", shut_in, TOY_M, source="perception")])
    table.occupancy = seen_from_above(world)
    assert table.observe(3 * CONFIG.gone_frames) == []
    if drawer:  # it goes once it can be seen to be gone from where the open drawer has taken it
        pull(world, drawer)
        x, y, z = shut_in.position_m
        out = Pose(position_m=(x + bodies(world)["chest1"].joints[-1].position, y, z))
        table = LooksAt().told([entity("toy1", "Bottle", out, TOY_M, source="perception")])
        table.occupancy = seen_from_above(world)
        assert [type(command) for command in table.observe(3 * CONFIG.gone_frames)] == [Remove]
