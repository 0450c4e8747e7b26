"""The contents of objects."""

import math

import pytest
from msgspec import structs

from semmap.nodes.kb_node.relations.contents import Contents
from semmap.nodes.kb_node.relations.facts.place_facts import Facts
from semmap.schemas.attachments import IS_GRASPED_BY
from semmap.schemas.entities import Pose, carried, orientation_from_yaw
from tests.kb_node.relations.entities import PROVENANCE, ROOM, TABLE, TOP, thing

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
        return Contents(facts.space, facts if request.param == "kept" else None)

    return made


def test_contents_at_any_depth(loads):
    there = loads(ROOM, TABLE, TRAY, BOWL, APPLE, CUP, BOOK, LOST)
    assert there.find_all("tray1") == ["bowl1", "cup1", "apple1"]
    assert there.find_all("table1") == ["book1", "tray1", "bowl1", "cup1", "apple1"]
    assert there.find_all("bowl1") == ["apple1"]
    assert there.find_all("cup1") == there.find_all("cup2") == there.find_all("missing") == []


def test_a_place_has_no_contents(loads):
    assert loads(ROOM, TABLE).find_all("kitchen1") == []


def test_excluded_objects_keep_their_contents(loads):
    there = loads(ROOM, TABLE, TRAY, BOWL, APPLE, CUP, BOOK)
    assert there.find_all("tray1", {"bowl1"}) == ["cup1"]
    assert there.find_all("table1", {"tray1", "cup1"}) == ["book1"]


def test_the_carrier_tells_inside_from_on(loads):
    there = loads(TABLE, BOWL, APPLE)
    assert [(name, bearer.is_inside) for name, bearer in there.find_direct("bowl1")] == [("apple1", True)]


def test_objects_at_one_spot_are_listed_once(loads):
    """Equal boxes at one spot support each other in no sensible order. The search must end."""
    heap = [thing(f"box{i}", (0.0, 0.0, 0.0), "unheard of", size=(0.1, 0.1, 0.04)) for i in range(30)]
    borne = loads(*heap).find_all("box0")
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
    """A tray is tilted by a quarter turn about x: what was above it is beside it."""
    half = math.sqrt(0.5)
    now = Pose(position_m=(0.0, 0.0, 1.0), orientation_wxyz=(half, half, 0.0, 0.0))
    there = carried(Pose(position_m=(0.1, 0.0, 0.2)), Pose(position_m=(0.0, 0.0, 0.0)), now)
    assert there.position_m == pytest.approx((0.1, -0.2, 1.0))


def test_a_move_without_rotation_keeps_the_orientation():
    cup = Pose(position_m=(0.0, 0.0, 0.0), orientation_wxyz=orientation_from_yaw(0.123456))
    was, now = Pose(position_m=(0.0, 0.0, 0.0)), Pose(position_m=(1.0, 0.0, 0.0))
    assert carried(cup, was, now).position_m == (1.0, 0.0, 0.0)
    assert carried(cup, was, now).orientation_wxyz == pytest.approx(cup.orientation_wxyz, abs=1e-6)


@pytest.mark.parametrize(("x", "y", "yaw"), [(-0.7, 0.5, 0.0), (-0.7, 0.5, math.pi / 2), (-0.8, 0.0, 0.4)])
def test_overlapping_furniture_is_not_contents(loads, x, y, yaw):
    couch, armchair = thing("couch1", (0.0, 0.0, 0.0)), thing("armchair1", (x, y, 0.005), yaw=yaw)
    there = loads(ROOM, couch, armchair)
    assert "couch1" not in there.find_all("armchair1")
    assert "armchair1" not in there.find_all("couch1")


def test_an_attached_object_is_contents_of_its_holder_only(loads):
    held = structs.replace(CUP, properties={IS_GRASPED_BY: "tray1"}, grip_provenance=PROVENANCE)
    assert loads(ROOM, TABLE, TRAY, BOWL, held).find_all("table1") == ["tray1", "bowl1"]
