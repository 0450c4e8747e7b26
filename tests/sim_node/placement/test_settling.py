from itertools import pairwise

import pytest

from tests.sim_node.orders import bodies, hand, order, pose, spawned

FRIDGE = (0.6, 0.6, 1.8)


def test_of_two_big_ones_in_one_place_the_later_is_a_ghost_until_there_is_room():
    world = spawned(
        order("fridge1", "", pose(0, 0), size_m=FRIDGE), order("fridge2", "", pose(0.3, 0), size_m=FRIDGE)
    )
    world.step(0.5)
    first, second = bodies(world)["fridge1"], bodies(world)["fridge2"]
    assert (first.ghost, second.ghost) == (False, True)
    assert (first.in_the_way, second.in_the_way) == ("", "fridge1")
    assert second.pose == pose(0.3, 0)
    assert second.resting
    version = world.scene().version
    world.move([hand("fridge1", pose(3, 0))])
    assert not bodies(world)["fridge2"].ghost
    assert world.scene().version > version  # so that those who only follow the poses look again
    world.step(0.5)
    assert bodies(world)["fridge2"].pose.position_m == pytest.approx((0.3, 0, 0), abs=0.002)


def test_a_ghost_turns_solid_when_the_other_is_deleted_and_can_be_moved_out():
    orders = [order(f"fridge{i}", "", pose(0.1 * i, 0), size_m=FRIDGE) for i in range(3)]
    world = spawned(*orders)
    assert sorted(b.ghost for b in bodies(world).values()) == [False, True, True]
    assert {b.in_the_way for b in bodies(world).values()} == {"", "fridge0"}
    world.move([hand("fridge1", pose(4, 0))])
    assert not bodies(world)["fridge1"].ghost
    world.delete(["fridge0"])
    assert not bodies(world)["fridge2"].ghost


def test_of_several_ghosts_in_one_place_the_earliest_gets_it():
    names = [f"fridge{i}" for i in range(6)]
    world = spawned(*(order(name, "", pose(0, 0), size_m=FRIDGE) for name in names))
    for gone, next_ in pairwise(names):
        world.delete([gone])
        assert {body.in_the_way for body in bodies(world).values() if body.ghost} <= {next_}
        assert [name for name, body in bodies(world).items() if not body.ghost] == [next_]


def test_a_ghost_turns_solid_where_it_has_to_be_lifted_a_little():
    world = spawned(order("table1", "table", pose(0, 0)), order("bottle1", "bottle", pose(0.1, 0, 0.75)))
    world.spawn([order("bottle2", "bottle", pose(0.12, 0, 0.74))])
    assert bodies(world)["bottle2"].ghost
    world.delete(["bottle1"])
    world.step(1.0)
    assert not bodies(world)["bottle2"].ghost
    assert bodies(world)["bottle2"].pose.position_m == pytest.approx((0.12, 0, 0.75), abs=0.002)


def test_a_ghost_turns_solid_when_the_other_was_pushed_away():
    world = spawned(order("bottle1", "bottle", pose(0, 0)), order("bottle2", "bottle", pose(0.02, 0)))
    (solid,) = (name for name, body in bodies(world).items() if not body.ghost)
    number = world.body_names().index(solid)
    for _ in range(50):
        world.data.xfrc_applied[world.model.geom_bodyid[number], 0] = -5.0
        world.step(0.01)
    world.data.xfrc_applied[:] = 0.0
    world.step(5.0)
    assert not any(body.ghost for body in bodies(world).values())


def test_a_ghost_turns_solid_when_what_came_with_it_has_fallen():
    world = spawned(order("bottle1", "bottle", pose(0, 0, 1)), order("bottle2", "bottle", pose(0.02, 0, 1)))
    assert sum(body.ghost for body in bodies(world).values()) == 1
    world.step(10.0)
    assert not any(body.ghost for body in bodies(world).values())
    world.step(2.0)
    assert all(body.pose.position_m[2] < 0.2 for body in bodies(world).values())


def test_a_ghost_of_many_parts_turns_solid_too():
    world = spawned(order("fridge1", "", pose(0, 0), size_m=FRIDGE), order("couch1", "couch", pose(0.2, 0)))
    assert sum(b.ghost for b in bodies(world).values()) == 1
    (ghost,) = (name for name, body in bodies(world).items() if body.ghost)
    world.move([hand(ghost, pose(5, 0))])
    assert not bodies(world)[ghost].ghost
    world.step(1.0)
    assert bodies(world)[ghost].pose.position_m == pytest.approx((5, 0, 0), abs=0.003)


def test_a_body_moved_into_another_is_a_ghost():
    world = spawned(order("a", "", pose(0, 0), size_m=FRIDGE), order("b", "", pose(3, 0), size_m=FRIDGE))
    world.step(0.5)
    world.move([hand("b", pose(0.2, 0))])
    assert bodies(world)["b"].ghost
    world.step(0.5)
    assert bodies(world)["a"].pose.position_m == pytest.approx((0, 0, 0), abs=0.001)
