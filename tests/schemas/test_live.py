from __future__ import annotations

import math

import pytest

from semmap.schemas import codec, errors, keys
from semmap.schemas.entities import Live, Pose, orientation_from_yaw
from semmap.schemas.live import LivePose, LivePoses


def test_json_and_messagepack_say_the_same():
    message = LivePose(at=(1.0, 2.0, 0.0), yaw=0.5, stamp_ns=7)
    assert codec.decode(codec.encode(message), LivePose) == message
    assert codec.decode(b'{"at": [1, 2, 0], "yaw": 0.5, "stamp_ns": 7}', LivePose) == message
    assert message.require_pose().orientation_wxyz == orientation_from_yaw(0.5)


def test_all_of_them_travel_together():
    live = Live(pose=Pose(position_m=(1.0, 2.0, 0.0)), stamp_ns=1, age_s=0.1, source="sim")
    message = LivePoses(stamp_ns=2, entities={"robot1": live})
    assert codec.decode(codec.encode(message), LivePoses) == message


@pytest.mark.parametrize(
    "fields",
    [
        {"at": [1.0, math.nan, 0.0]},
        {"at": [math.inf, 0.0, 0.0]},
        {"at": [1.0, 2.0]},
        {"at": [1e6, 0.0, 0.0]},
        {"at": [1.0, 2.0, 0.0], "yaw": math.nan},
        {"at": [1.0, 2.0, 0.0], "stamp_ns": -1},
        {"at": [1.0, 2.0, 0.0], "orientation": [1.0, 1.0, 0.0, 0.0]},
        {"at": [1.0, 2.0, 0.0], "orientation": [1.0, 0.0, 0.0, 0.0], "yaw": 1.0},
        {"at": [1.0, 2.0, 0.0], "name": "robot1"},
        {},
    ],
)
def test_invalid_poses_are_rejected(fields):
    with pytest.raises(errors.BadRequest):
        codec.decode(codec.encode(fields), LivePose).require_pose()


def test_the_key_has_the_name():
    for name in ("robot1", "Roboter_ü", "a.b-c"):
        assert keys.of_live_pose(keys.live_pose_key(name)) == name
