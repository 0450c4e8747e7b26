import pytest

from tests.sim_node.orders import bodies, order, pose, spawned

FRIDGE = (0.6, 0.6, 1.8)


def test_a_cup_said_to_be_where_the_table_is_stands_on_it():
    world = spawned(order("cup1", "cup", pose(1, 1)), order("table1", "table", pose(1, 1)))
    world.step(0.5)
    assert bodies(world)["cup1"].pose.position_m == pytest.approx((1, 1, 0.75), abs=0.002)
    assert bodies(world)["table1"].pose.position_m == pytest.approx((1, 1, 0), abs=0.002)


def test_a_whole_tower_may_be_said_to_be_at_one_spot():
    world = spawned(*(order(name, name, pose(1, 1)) for name in ("cup", "tray", "table", "book")))
    world.step(0.5)
    heights = {name: body.pose.position_m[2] for name, body in bodies(world).items()}
    assert heights["table"] < 0.01 < 0.74 < heights["tray"] < heights["book"] < heights["cup"]


def test_a_table_that_comes_later_lifts_the_cup():
    world = spawned(order("cup1", "cup", pose(1, 1)))
    world.spawn([order("cabinet1", "", pose(1, 1.1), size_m=(0.8, 0.8, 0.7))])
    world.step(0.5)
    assert bodies(world)["cup1"].pose.position_m == pytest.approx((1, 1, 0.7), abs=0.002)


def test_it_does_not_matter_whether_the_cup_or_the_table_comes_first():
    world = spawned(order("cup1", "cup", pose(1, 1)), order("can1", "can", pose(1.2, 1.1)))
    world.step(0.5)
    world.spawn([order("table1", "table", pose(1, 1))])
    world.step(0.5)
    assert bodies(world)["cup1"].pose.position_m == pytest.approx((1, 1, 0.75), abs=0.002)
    assert bodies(world)["can1"].pose.position_m == pytest.approx((1.2, 1.1, 0), abs=0.002)  # below it


def test_what_may_well_be_under_a_table_stays_there():
    world = spawned(
        order("table1", "table", pose(0, 0)), order("box1", "", pose(0.2, 0.1), size_m=(0.2, 0.2, 0.3))
    )
    world.step(0.5)
    assert bodies(world)["box1"].pose.position_m == pytest.approx((0.2, 0.1, 0), abs=0.002)


def test_small_things_stand_on_the_lowest_shelf_that_has_room():
    world = spawned(order("bookshelf1", "bookshelf", pose(0, 0)), order("can1", "can", pose(0, 0)))
    world.step(0.5)
    can = bodies(world)["can1"].pose.position_m
    assert can[:2] == pytest.approx((0, 0), abs=0.002)
    assert 0.0 < can[2] < 0.1


def test_a_body_below_the_floor_is_lifted_onto_it():
    world = spawned(order("a", "", pose(0, 0, -0.7), size_m=FRIDGE), order("cup1", "cup", pose(2, 0, -3)))
    world.step(0.5)
    assert bodies(world)["a"].pose.position_m == pytest.approx((0, 0, 0), abs=0.001)
    assert bodies(world)["cup1"].pose.position_m == pytest.approx((2, 0, 0), abs=0.001)


def test_fixed_things_may_share_a_place():
    wall = order("wall1", "", pose(0, 0), size_m=(4, 0.1, 2.5), fixed=True)
    door = order("door1", "", pose(0, 0), size_m=(0.9, 0.12, 2.1), fixed=True)
    world = spawned(wall, door)
    assert not any(b.ghost for b in bodies(world).values())


def test_what_stands_in_a_wall_is_a_ghost_not_lifted_on_top():
    world = spawned(
        order("wall1", "", pose(0, 0), size_m=(4, 0.1, 2.5), fixed=True),
        order("bin1", "", pose(0, 0.05), size_m=(0.3, 0.3, 0.4)),
    )
    assert bodies(world)["bin1"].ghost
    assert bodies(world)["bin1"].pose == pose(0, 0.05)


def test_neighbours_that_only_touch_are_left_alone():
    world = spawned(order("a", "", pose(0, 0), size_m=FRIDGE), order("b", "", pose(0.6, 0), size_m=FRIDGE))
    assert not any(b.ghost for b in bodies(world).values())
    world.step(1.0)
    assert bodies(world)["b"].pose.position_m == pytest.approx((0.6, 0, 0), abs=0.002)
