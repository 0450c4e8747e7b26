"""The printed frame tree."""

from __future__ import annotations

from semmap.nodes.extern.cli.output.show import console, frame_tree
from semmap.schemas.entities import Pose
from semmap.schemas.frames import Frame

_HERE = Pose(position_m=(1.0, 0.0, 0.0))
_LEANING = Pose(position_m=(0.0, 0.0, 1.0), orientation_wxyz=(0.6, 0.8, 0.0, 0.0))


def printed(*frames: Frame) -> str:
    out = console()
    with out.capture() as captured:
        out.print(frame_tree(frames))
    return captured.get()


def frame(name, parent, source="map", pose=_HERE, **fields):
    return Frame(name=name, parent=parent, source=source, pose=pose, map_pose=pose, **fields)


def test_frames_are_below_those_that_they_are_in():
    lines = printed(
        frame("map", ""),
        frame("robot1", "map", "sim", age_s=0.1),
        frame("robot1_head", "robot1", "camera", _LEANING),
        frame("dock", "map", "stream"),
        frame("lidar", "dock", "stream", age_s=9.0, stale=True, problem="it is stale"),
    ).splitlines()
    assert lines[0] == "map"
    assert lines[1].startswith("├── robot1  (1.000, 0.000, 0.000) m, yaw 0°  from the simulator")
    assert "└── robot1_head  (0.000, 0.000, 1.000) m, wxyz 0.600 0.800 0.000 0.000  a camera" in lines[2]
    assert lines[3].endswith("from a stream, fixed")
    assert lines[4].endswith("(it is stale)")


def test_a_frame_without_a_parent_that_is_there_comes_last():
    lines = printed(frame("map", ""), frame("lidar", "unknown", "stream", problem="no parent")).splitlines()
    assert "lidar" in lines[-1]
    assert "in unknown" in lines[-1]
