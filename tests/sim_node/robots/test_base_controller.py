"""The controller turns the base first, passes through points, slows down, and reports the outcome."""

import math

import mujoco
import numpy as np
import pytest

from semmap.nodes.sim_node.bodies import BodyIndex
from semmap.nodes.sim_node.models.parts import about
from semmap.nodes.sim_node.robots.base_controller import BaseController, actuators
from tests.sim_node.test_bodies import record


class Base:
    """A base with a fixed pose; `ctrl` has the velocity commands."""

    def __init__(self, at=(0.0, 0.0), yaw_rad=0.0, origin_m=(0.0, 0.0, -0.1)):
        spec = mujoco.MjSpec()
        body = spec.worldbody.add_body(name="base")
        body.add_freejoint(name="base")
        body.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=[0.2, 0.2, 0.1])
        other = spec.worldbody.add_body(name="can")
        other.add_freejoint(name="can")
        other.add_geom(size=[0.1, 0, 0])
        for axis in ("drive_yaw", "drive_x", "drive_y"):  # in any order
            spec.add_actuator(name=f"base_{axis}", target="base", trntype=mujoco.mjtTrn.mjTRN_JOINT)
        spec.add_actuator(name="can_drive_x", target="can", trntype=mujoco.mjtTrn.mjTRN_JOINT)
        self.model = spec.compile()
        self.data = mujoco.MjData(self.model)
        self.records = {"can": record("can"), "base": record("base", origin_m=origin_m)}
        self.index = BodyIndex.of(
            self.model, self.records, {name: self.model.body(name).id for name in self.records}
        )
        self.courses = BaseController()
        self.put(at, yaw_rad)

    def put(self, at, yaw_rad=0.0, roll_rad=0.0):
        start = self.index.qpos[self.index.row["base"]]
        turn = about("x", roll_rad) if roll_rad else about("z", yaw_rad)
        self.data.qpos[start : start + 7] = [*at, 0.1, *turn]

    def steer(self):
        self.courses.steer(self.model, self.data, self.index)
        x, y, yaw = (float(self.data.ctrl[n]) for n in actuators(self.model, "base"))
        return x, y, yaw

    def ended(self):
        return self.courses.ended.get("base")


def test_a_base_is_what_has_all_three_actuators():
    base = Base()
    assert actuators(base.model, "base") == (1, 2, 0)
    assert actuators(base.model, "can") == ()


def test_it_goes_straight_at_what_is_ahead_at_the_speed_it_is_told():
    base = Base()
    assert not base.courses
    base.courses.begin("base", [(2.0, 0.0)], None, 0.4)
    assert base.courses
    assert base.steer() == pytest.approx((0.4, 0.0, 0.0))


def test_far_off_it_turns_towards_its_point_before_it_goes():
    base = Base()
    base.courses.begin("base", [(0.0, 2.0)], None, 0.4)
    assert base.steer() == pytest.approx((0.0, 0.0, 1.2))  # as fast as it turns at most
    base.put((0.0, 0.0), yaw_rad=math.pi)
    assert base.steer() == pytest.approx((0.0, 0.0, -1.2))  # the shorter way
    base.put((0.0, 0.0), yaw_rad=math.pi / 2 - 0.2)
    x, y, yaw = base.steer()
    assert (x, y, yaw) == pytest.approx((0.4 * math.cos(0.2), 0.4 * math.sin(0.2), 0.5))


def test_near_its_end_it_slows_down_and_turns_to_where_it_is_to_face():
    base = Base(at=(1.8, 0.1))
    base.courses.begin("base", [(2.0, 0.1)], 1.0, 0.4)
    assert base.steer() == pytest.approx((1.6 * 0.2, 0.0, 1.2))
    base.put((1.8, 0.1), yaw_rad=0.9)
    x, y, yaw = base.steer()
    assert (x, y) == pytest.approx((0.32 * math.cos(0.9), -0.32 * math.sin(0.9)))
    assert yaw == pytest.approx(0.25)


def test_without_a_heading_it_stays_as_it_is_turned():
    base = Base(at=(1.8, 0.0), yaw_rad=0.7)
    base.courses.begin("base", [(2.0, 0.0)], None, 0.4)
    assert base.steer()[2] == 0.0


def test_it_is_there_when_it_is_near_enough_and_turned():
    base = Base(at=(1.99, 0.0), yaw_rad=0.05)
    base.courses.begin("base", [(2.0, 0.0)], 0.0, 0.4)
    base.steer()
    assert base.ended() is None
    base.put((1.98, 0.0), yaw_rad=0.0)
    base.steer()
    assert base.ended() is None
    base.put((1.99, 0.0), yaw_rad=0.01)
    assert base.steer() == (0.0, 0.0, 0.0)
    assert base.ended() == "there"
    assert not base.courses


def test_points_on_the_way_are_only_passed_and_the_last_is_not():
    base = Base(at=(0.9, 0.0))
    base.courses.begin("base", [(1.0, 0.0), (1.0, 3.0)], None, 0.4)
    base.steer()
    base.put((1.0, 0.0), yaw_rad=math.pi / 2)
    assert base.steer() == pytest.approx((0.4, 0.0, 0.0))  # on to the second
    base.put((1.0, 2.9), yaw_rad=math.pi / 2)
    base.steer()
    assert base.ended() is None


def test_on_the_way_it_does_not_turn_to_where_it_faces_at_the_last():
    base = Base(at=(0.8, 0.0))
    base.courses.begin("base", [(1.0, 0.0), (1.0, 3.0)], 1.0, 0.4)
    assert base.steer() == pytest.approx((0.32, 0.0, 0.0))


def test_what_comes_no_nearer_for_a_while_is_blocked():
    base = Base()
    base.courses.begin("base", [(2.0, 0.0)], None, 0.4)
    base.steer()
    base.data.time = 3.9
    base.steer()
    assert base.ended() is None
    base.put((0.02, 0.0))  # it is nearer, so it has time again
    base.steer()
    base.data.time = 7.8
    base.put((0.025, 0.0))  # not by enough
    base.steer()
    assert base.ended() is None
    base.data.time = 8.0
    base.steer()
    assert base.ended() == "blocked"
    assert base.data.ctrl.tolist() == [0.0] * 4


def test_who_begins_late_has_as_much_time():
    base = Base()
    base.data.time = 100.0
    base.courses.begin("base", [(2.0, 0.0)], None, 0.4)
    base.steer()
    assert base.ended() is None


def test_after_a_point_the_way_to_the_next_is_measured_anew():
    base = Base(at=(0.9, 0.0))
    base.courses.begin("base", [(1.0, 0.0), (1.0, 30.0)], None, 0.4)
    base.steer()
    base.data.time = 5.0
    base.steer()
    assert base.ended() is None


def test_what_leans_far_over_has_fallen():
    base = Base()
    base.courses.begin("base", [(2.0, 0.0)], None, 0.4)
    base.put((0.0, 0.0), roll_rad=0.2)
    base.steer()
    assert base.ended() is None
    base.put((0.0, 0.0), roll_rad=1.2)
    base.steer()
    assert base.ended() == "fallen"


def test_its_bottom_centre_is_what_drives_wherever_the_middle_of_its_mass_is():
    base = Base(at=(1.0, 1.0), yaw_rad=math.pi / 2, origin_m=(0.5, 0.2, -0.1))
    base.courses.begin("base", [(0.8, 1.5)], math.pi / 2, 0.4)
    base.steer()
    assert base.ended() == "there"


def test_another_course_takes_the_place_of_one_and_stopping_ends_it():
    base = Base()
    base.courses.begin("base", [(2.0, 0.0)], None, 0.4)
    assert base.ended() is None
    assert base.courses.paths == {"base": ((2.0, 0.0),)}
    base.courses.begin("base", [(-2.0, 0.0)], None, 0.3)
    assert base.ended() == "stopped"
    assert base.courses.paths == {"base": ((-2.0, 0.0),)}
    base.put((0.0, 0.0), yaw_rad=math.pi)
    assert base.steer() == pytest.approx((0.3, 0.0, 0.0))
    base.courses.ended.clear()
    base.courses.stop(base.model, base.data, "base", "stopped")
    assert base.ended() == "stopped"
    base.courses.ended.clear()
    assert not base.courses.paths
    base.courses.stop(base.model, base.data, "base", "stopped")
    assert base.ended() is None  # there was none


def test_a_base_that_is_gone_or_held_is_blocked():
    base = Base()
    base.courses.begin("base", [(2.0, 0.0)], None, 0.4)
    base.courses.begin("robot9", [(2.0, 0.0)], None, 0.4)
    base.courses.begin("can", [(2.0, 0.0)], None, 0.4)
    base.steer()
    assert base.courses.ended == {"robot9": "blocked", "can": "blocked"}
    base.records["base"].ghost = True
    held = BodyIndex.of(base.model, base.records, {"base": 1, "can": 2})
    base.courses.steer(base.model, base.data, held)
    assert base.ended() == "blocked"
    assert not base.courses
    assert np.isfinite(base.data.ctrl).all()
