"""What goes along with what."""

import math

import pytest
from msgspec import structs

from semmap.nodes.kb_node.relations.carrying import Loads
from semmap.nodes.kb_node.relations.facts.place_facts import Facts
from semmap.schemas.attachments import IS_GRASPED_BY
from semmap.schemas.entities import Pose, carried, orientation_from_yaw
from tests.kb_node.relations.made import NOBODY, ROOM, TABLE, TOP, thing

TRAY = thing("tray1", (0.0, 0.0, TOP), "unheard of", size=(0.5, 0.4, 0.02))
BOWL = thing("bowl1", (0.1, 0.0, TOP + 0.02))
APPLE = thing("apple1", (0.1, 0.0, TOP + 0.04))
CUP = thing("cup1", (-0.15, 0.0, TOP + 0.02))
BOOK = thing("book1", (0.4, 0.0, TOP))
LOST = thing("cup2", None)


@pytest.fixture(params=["kept", "measured"])
def loads(request):
    def made(*entities):
        facts = Facts()
        facts.update(entities)
        return Loads(facts.space, facts if request.param == "kept" else None)

    return made


def test_all_that_stands_on_it_or_is_inside_it_and_on_that(loads):
    there = loads(ROOM, TABLE, TRAY, BOWL, APPLE, CUP, BOOK, LOST)
    assert there.all_of("tray1") == ["bowl1", "cup1", "apple1"]
    assert there.all_of("table1") == ["book1", "tray1", "bowl1", "cup1", "apple1"]
    assert there.all_of("bowl1") == ["apple1"]
    assert there.all_of("cup1") == there.all_of("cup2") == there.all_of("nobody") == []


def test_a_place_bears_nothing(loads):
    assert loads(ROOM, TABLE).all_of("kitchen1") == []


def test_what_is_left_stays_with_all_that_only_it_bears(loads):
    there = loads(ROOM, TABLE, TRAY, BOWL, APPLE, CUP, BOOK)
    assert there.all_of("tray1", {"bowl1"}) == ["cup1"]
    assert there.all_of("table1", {"tray1", "cup1"}) == ["book1"]


def test_whether_it_is_inside_is_told(loads):
    there = loads(TABLE, BOWL, APPLE)
    assert [(name, bearer.is_inside) for name, bearer in there.directly_on("bowl1")] == [("apple1", True)]


def test_things_in_one_spot_carry_one_another_at_most_once(loads):
    """Equal boxes in one spot are on one another in no sensible order: there is an end to it."""
    heap = [thing(f"box{i}", (0.0, 0.0, 0.0), "unheard of", size=(0.1, 0.1, 0.04)) for i in range(30)]
    borne = loads(*heap).all_of("box0")
    assert len(borne) == len(set(borne))
    assert "box0" not in borne


@pytest.mark.parametrize("yaw", [0.0, 0.4, math.pi / 2, math.pi, -2.0])
def test_carried_is_rigid(yaw):
    was = Pose(position_m=(1.0, 2.0, 0.5), orientation_wxyz=orientation_from_yaw(0.3))
    now = Pose(position_m=(-4.0, 1.0, 0.9), orientation_wxyz=orientation_from_yaw(0.3 + yaw))
    cup = Pose(position_m=(1.2, 2.1, 0.52), orientation_wxyz=orientation_from_yaw(-0.7))
    there = carried(cup, was, now)
    dx, dy = 0.2, 0.1
    c, s = math.cos(yaw), math.sin(yaw)
    assert there.position_m == pytest.approx((-4.0 + c * dx - s * dy, 1.0 + s * dx + c * dy, 0.92), abs=2e-6)
    assert math.remainder(there.yaw_rad - (yaw - 0.7), 2 * math.pi) == pytest.approx(0.0, abs=5e-6)
    back = carried(there, now, was)
    assert back.position_m == pytest.approx(cup.position_m, abs=1e-5)


def test_carried_over_a_tilt():
    """A tray that is tipped by a quarter about x: what was above it is beside it."""
    half = math.sqrt(0.5)
    now = Pose(position_m=(0.0, 0.0, 1.0), orientation_wxyz=(half, half, 0.0, 0.0))
    there = carried(Pose(position_m=(0.1, 0.0, 0.2)), Pose(position_m=(0.0, 0.0, 0.0)), now)
    assert there.position_m == pytest.approx((0.1, -0.2, 1.0))


def test_carried_without_a_turn_keeps_the_orientation():
    cup = Pose(position_m=(0.0, 0.0, 0.0), orientation_wxyz=orientation_from_yaw(0.123456))
    was, now = Pose(position_m=(0.0, 0.0, 0.0)), Pose(position_m=(1.0, 0.0, 0.0))
    assert carried(cup, was, now).position_m == (1.0, 0.0, 0.0)
    assert carried(cup, was, now).orientation_wxyz == pytest.approx(cup.orientation_wxyz, abs=1e-6)


@pytest.mark.parametrize(("x", "y", "yaw"), [(-0.7, 0.5, 0.0), (-0.7, 0.5, math.pi / 2), (-0.8, 0.0, 0.4)])
def test_furniture_that_overlaps_does_not_carry_the_other(loads, x, y, yaw):
    couch, armchair = thing("couch1", (0.0, 0.0, 0.0)), thing("armchair1", (x, y, 0.005), yaw=yaw)
    there = loads(ROOM, couch, armchair)
    assert "couch1" not in there.all_of("armchair1")
    assert "armchair1" not in there.all_of("couch1")


def test_what_is_held_is_carried_by_its_holder_only(loads):
    held = structs.replace(CUP, properties={IS_GRASPED_BY: "tray1"}, grip_provenance=NOBODY)
    assert loads(ROOM, TABLE, TRAY, BOWL, held).all_of("table1") == ["tray1", "bowl1"]
