"""Adds a robot's MJCF to a world, one body with its parts, cameras and actuators, and measures its state."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Final

import mujoco
import numpy as np

from semmap.nodes.sim_node.bodies import Floats, pose_of
from semmap.nodes.sim_node.config import RobotConfig
from semmap.nodes.sim_node.physics import base_scene
from semmap.schemas.entities import Pose, compose, inverse
from semmap.schemas.errors import BadFile
from semmap.schemas.live import RobotState

SHIPPED: Final = {"porter": Path(__file__).with_name("porter.xml")}
"""The robots that ship with semmap, by name."""


def add_robot(ground: mujoco.MjSpec, robot: RobotConfig) -> None:
    """Add a robot to a world that is not compiled yet, at `at_m` on the floor, facing `yaw_rad`.

    The file must have one body on the top level, which gets the name `name`; all other elements, including
    cameras, get the prefix `name_`. Raises BadFile for an invalid file.
    """
    spec = read(robot.path)
    (root,) = spec.worldbody.bodies
    if any(body.name == robot.name for body in ground.bodies):
        raise BadFile(f"the world already has a body named {robot.name}; use another name: --robot-name NAME")
    if not any(joint.type == mujoco.mjtJoint.mjJNT_FREE for joint in root.joints):
        root.add_freejoint()
    own = [*spec.bodies[1:], *spec.joints, *spec.cameras, *spec.sites, *spec.actuators]
    names = [(element, element.name) for element in own]
    texts = [(text.name, text.data) for text in spec.texts]
    frame = ground.worldbody.add_frame(
        pos=list(robot.at_m), quat=[math.cos(robot.yaw_rad / 2), 0.0, 0.0, math.sin(robot.yaw_rad / 2)]
    )
    prefix = f"{robot.name}_"
    ground.attach(spec, prefix=prefix, frame=frame)
    for element, name in names:
        element.name = robot.name if element is names[0][0] else f"{prefix}{name}" if name else ""
    for name, class_ in texts:  # which of its parts are entities
        head, colon, part = name.partition(":")
        if colon and head == "semmap":
            ground.add_text(name=f"semmap:{prefix}{part}", data=class_)
    root = ground.body(robot.name)
    root.sleep = mujoco.mjtSleepPolicy.mjSLEEP_ALLOWED  # else a body with actuators never sleeps


def read(path: Path) -> mujoco.MjSpec:
    """Read the robot of a file. Raises BadFile unless it compiles and has exactly one top-level body."""
    spec = base_scene.read_mjcf(path)
    bodies = [body.name or "(nameless)" for body in spec.worldbody.bodies]
    if len(bodies) != 1:
        there = ", ".join(bodies) or "none"
        raise BadFile(f"{path} is not a robot: it must have one top-level body; it has {there}")
    for geom in list(spec.worldbody.geoms):  # such as a floor for trying it out
        spec.delete(geom)
    for light in list(spec.worldbody.lights):
        spec.delete(light)
    return spec


class RobotSensor:
    """Measures the base and the joints of a robot that `add_robot` added to the world."""

    def __init__(self, robot: RobotConfig) -> None:
        """Read the robot's file. Raises BadFile as `read` does."""
        self.name = robot.name
        own = read(robot.path).compile()
        self._body_from_origin = inverse(_pose(own.body_pos[1], own.body_quat[1]))

    def state(self, model: mujoco.MjModel, data: mujoco.MjData, stamp_ns: int) -> RobotState:
        """Return the state of the robot in a world, with the names of the robot's file."""
        body, prefix = model.body(self.name).id, f"{self.name}_"
        single = int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE)
        joints = {
            name.removeprefix(prefix): float(data.qpos[model.jnt_qposadr[n]])
            for n in range(model.njnt)
            if model.jnt_type[n] in single
            and model.body_rootid[model.jnt_bodyid[n]] == body
            and (name := model.joint(n).name).startswith(prefix)
        }
        origin = compose(_pose(data.xpos[body], data.xquat[body]), self._body_from_origin)
        at, turn = origin.position_m, origin.orientation_wxyz
        return RobotState(at=at, orientation=turn, joints=joints, stamp_ns=stamp_ns)


def _pose(at: Floats, turn: Floats) -> Pose:
    return pose_of(np.concatenate([at, turn]))
