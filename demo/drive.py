"""The second part of the tour: a robot in the flat, and an object that is put into the fridge."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from demo.tour import Tour

ROBOT = ("--robot", "porter", "--robot-at", "7.6", "1.2", "0", "--robot-yaw", "3.14")
CAMERA = ("--camera-hz", "2", "--camera-size", "320", "240")


def drive(t: Tour) -> None:
    """Open the fridge, put the milk in, close it, drive past, and search for the milk."""
    t.heading("A robot is a tracked entity; its cameras and parts are frames")
    t.until("map and scene agree", t.agrees)
    t.do("get", "robot1", holds="from the simulator")
    t.do("frames", "robot1_head", holds="a camera")

    t.heading("Open the fridge, put the milk in, close it: manual changes are committed")
    t.do("open", "fridge1", "--joint", "door", holds="door open to 100%")
    t.do("move", "milk1", "--at", "6.55", "0.3", "0.64", holds="moved milk1")
    t.do("list", "--in", "fridge1", holds="milk1")
    t.do("close", "fridge1", holds="door closed")
    t.do("explain", "milk1", "type", "Chilled_Food", holds="100% of its volume is within a hollow of fridge1")

    t.heading("Attach the apple to the gripper: it moves with the robot")
    t.do("attach", "apple1", "--to", "robot1_gripper", "--at", "0.06", "0", "0", holds="is attached to")
    t.do("drive", "robot1", "--to", "6.75", "1.2", "--yaw", "-90deg", holds="robot1 is at")
    t.do("list", "--nearest", "3", "--to", "robot1", holds="fridge1")
    t.do("get", "apple1", holds="from the attachment to robot1_gripper")

    t.heading("Drive past the counter where the milk was, and detach the apple")
    t.do("drive", "robot1", "--to", "8.4", "1.15", "--yaw", "0", holds="robot1 is at")
    t.do("detach", "apple1", holds="apple1 is detached")

    t.heading("Where is the milk? No camera sees it, but the map contains it")
    t.do("find", "the milk in the fridge", holds="milk1")
    t.do("relations", "milk1", "fridge1", holds="milk1 is inside fridge1")
    t.do("last-seen", "milk1", holds="not observable: fridge1 has been closed since")
    t.do("when", "milk1", "isOn", "counter1", holds="milk1 is no longer on counter1")
    t.do("route", "robot1", "bed1", holds="through door7")
