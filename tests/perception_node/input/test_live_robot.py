"""A robot is left out of live frames by the state of their moment."""

import numpy as np
import pytest

from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.input.live_robot import LiveRobot
from semmap.schemas.errors import BadRequest
from semmap.schemas.live import RobotState
from tests.perception_node.input.test_robot_mask import POST

SECOND_NS = 1_000_000_000
ALONG_X = np.array([[0.0, 0, 1, 0], [-1, 0, 0, 0], [0, -1, 0, 0.5], [0, 0, 0, 1]])
"""A camera at the map's origin that looks along x."""


@pytest.fixture
def robot(tmp_path):
    (tmp_path / "post.urdf").write_text(POST)
    return LiveRobot("robot1", tmp_path / "post.urdf")


def state(x, lift, stamp_s, **changes):
    fields = {"at": (x, 0.0, 0.0), "joints": {"lift": lift}, "stamp_ns": int(stamp_s * SECOND_NS)}
    return RobotState(**fields | changes)


def kept(robot, stamp_s=10.0):
    """Return which of three points remain: before a post at 1 m, between this and 2 m, and behind both."""
    cloud = Cloud(
        np.array([[[0.0, 0, 0.5], [0, 0, 1.5], [0, 0, 2.5]]]),
        map_from_camera=ALONG_X,
        stamp_ns=int(stamp_s * SECOND_NS),
    )
    left = robot.remove_from(cloud)
    assert left.notes == ()
    return np.isfinite(left.points_camera[0, :, 2]).tolist()


def test_the_state_of_the_moment_of_a_frame_counts(robot):
    for stamp_s, lift in ((9.0, 0.0), (10.05, 2.0), (9.98, 1.0), (11.0, 0.0)):
        robot.keep(state(0.0, lift, stamp_s))
    assert kept(robot) == [True, False, False]
    assert kept(robot, 10.06) == [True, True, False]


def test_the_base_moves_the_robot_and_one_elsewhere_is_no_doubt(robot):
    robot.keep(state(-1.0, 2.0, 10.0))
    robot.keep(state(0.0, -2.0, 10.3, orientation=(0.0, 0.0, 0.0, 1.0)))
    robot.keep(state(0.0, 1.0, 10.6, yaw=1.5))
    assert kept(robot, 10.0) == [True, False, False]
    assert kept(robot, 10.3) == [True, True, False]
    assert kept(robot, 10.6) == [True, True, True]


@pytest.mark.parametrize(
    ("given", "error"),
    [
        (None, "nothing received on semmap/robot/robot1"),
        (state(0.0, 1.0, 9.8), "no state on semmap/robot/robot1 within 0.1 s of a frame"),
        (state(0.0, 1.0, 10.0, joints={"knee": 1.0}), "post.urdf has no joint 'knee'; its joints: lift"),
        (state(0.0, 1.0, 10.0, orientation=(1.0, 1.0, 0.0, 0.0)), "robot1 needs a unit quaternion"),
    ],
)
def test_without_a_valid_state_of_that_moment_the_reason_is_told(robot, given, error):
    robot.keep(state(0.0, 1.0, 10.0))
    robot.keep(None)  # the publisher withdrew it
    if given is not None:
        robot.keep(given)
    with pytest.raises(BadRequest, match=f"robot1 is not left out of frames: .*{error}"):
        kept(robot)
