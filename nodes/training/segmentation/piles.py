"""Made-up scenes: things on a table, apart, side by side and on one another, seen by a depth camera."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import mujoco
import numpy as np
from numpy.typing import NDArray

from nodes.perception_node.cloud import Cloud
from nodes.perception_node.files.pictures import back_project
from nodes.sim_node.build import add_part
from nodes.sim_node.models.library import Model, assemble, build
from nodes.sim_node.models.parts import box, rod
from nodes.sim_node.models.table import MODELS
from nodes.sim_node.vision.camera import Eye
from nodes.sim_node.vision.noise import kinect_noise
from nodes.sim_node.vision.view import View, look_at

_BIGGEST_M, _SMALLEST_M = 0.36, 0.03
_HIGHEST_M = 0.42  # of a tower
_KINDS = tuple(
    name
    for name, kind in MODELS.items()
    if max(kind.size_m) <= _BIGGEST_M and sorted(kind.size_m)[1] >= _SMALLEST_M
)
_PLAIN = 0.4  # of the things are mere boxes and cylinders: packets and tins
_SIZE = (640, 480)
_FOVY_RAD = 2 * math.atan(240 / 525)
_PARKED_M = 20.0
_STEP_M, _FINE_M = 0.02, 0.0005


class Pile(NamedTuple):
    """What the camera saw, and (H, W) the number of the thing at each pixel, 0 for the table."""

    cloud: Cloud
    truth: NDArray[np.int32]


def pile(rng: np.random.Generator, eye: Eye) -> Pile:
    """A table with 2 to 14 things on it."""
    models = [_thing(rng) for _ in range(int(rng.integers(2, 15)))]
    scene = _Scene(models)
    view = _view(rng)
    eye_m = view.map_from_camera[:2, 3]
    area = rng.uniform(0.15, 0.45)
    placed: list[int] = []
    for thing in range(len(models)):
        scene.place(thing, placed, area, eye_m, rng)
        placed.append(thing)
    mujoco.mj_forward(scene.model, scene.data)
    rgb, depth_m = eye.see(scene.model, scene.data, view)
    geom = eye.segment(scene.model, scene.data, view)
    body = np.where(geom >= 0, scene.model.geom_bodyid[geom], 0)
    depth_m = _seen(depth_m, rng)
    cloud = Cloud(back_project(depth_m, view.intrinsics), rgb, None, view.intrinsics)
    return Pile(cloud, np.where(depth_m > 0, body, 0).astype(np.int32))


def _thing(rng: np.random.Generator) -> Model:
    """A thing of the library at some size, or a plain box or cylinder."""
    if rng.random() < _PLAIN:
        x, y, z = np.exp(rng.uniform(np.log(0.03), np.log(0.26), 3))
        colour = tuple(rng.uniform(0.1, 0.9, 3))
        if rng.random() < 0.6:
            part = box((x, y, z), (0.0, 0.0, z / 2), colour)
        else:
            part = rod(x / 2, z, (0.0, 0.0, z / 2), colour)
        return assemble("plain", [part], 0.5)
    name = str(rng.choice(_KINDS))
    size = np.array(MODELS[name].size_m) * rng.uniform(0.7, 1.25) * rng.uniform(0.85, 1.15, 3)
    return build(name, tuple(float(side) for side in np.clip(size, 0.005, 0.5)))


class _Scene:
    """Bodies that are put down one after the other until they touch something, without physics."""

    def __init__(self, models: list[Model]) -> None:
        spec = mujoco.MjSpec()
        spec.worldbody.add_light(pos=[0.5, -1.0, 3.0])
        spec.worldbody.add_geom(
            type=mujoco.mjtGeom.mjGEOM_BOX, size=[1.0, 1.0, 0.02], pos=[0, 0, -0.02], rgba=[0.7, 0.6, 0.5, 1]
        )
        for number, model in enumerate(models):
            body = spec.worldbody.add_body(pos=[_PARKED_M + number, 0, 1])
            body.add_freejoint()
            body.explicitinertial, body.mass, body.inertia = True, 1.0, [0.01, 0.01, 0.01]
            for part in model.parts:
                add_part(body, part)
        self.model = spec.compile()
        self.data = mujoco.MjData(self.model)
        self._sizes = [model.size_m for model in models]

    def place(
        self,
        thing: int,
        placed: list[int],
        area_m: float,
        eye_m: NDArray[np.float64],
        rng: np.random.Generator,
    ) -> None:
        """Put a thing on the table, on top of another one, between one and the eye, or beside one."""
        pose = self.data.qpos[7 * thing : 7 * thing + 7]
        pose[3:] = _turn(rng)
        way = rng.random() if placed else 0.0
        spot = rng.uniform(-area_m, area_m, 2)
        if way < 0.25:
            self._lower(thing, spot)
            return
        other = int(rng.choice(placed))
        target = self.data.qpos[7 * other : 7 * other + 2].copy()
        if way < 0.5:
            self._lower(thing, target + rng.normal(0, 0.03, 2))
            if pose[2] > _HIGHEST_M - 0.1:
                self._lower(thing, spot)
            return
        angle = rng.uniform(-math.pi, math.pi)
        away = np.array([math.cos(angle), math.sin(angle)])
        if way < 0.75:
            away = (eye_m - target) / np.linalg.norm(eye_m - target)
        self._lower(thing, target + away * (_PARKED_M / 2))
        height = pose[2]
        self._slide(thing, target, away, height)
        if rng.random() < 0.5:
            pose[:2] += away * rng.uniform(0.0, 0.06)

    def _lower(self, thing: int, spot: NDArray[np.float64]) -> None:
        pose = self.data.qpos[7 * thing : 7 * thing + 7]
        pose[:2] = spot
        on_table = abs(spot).max() < 1.0

        def at(height: float) -> bool:
            pose[2] = height
            return self._touches(thing) if on_table else self._lowest(thing) < 0

        pose[2] = _last_free(at, 1.2)

    def _slide(
        self, thing: int, target: NDArray[np.float64], away: NDArray[np.float64], height: float
    ) -> None:
        pose = self.data.qpos[7 * thing : 7 * thing + 7]
        pose[2] = height + 0.001

        def at(distance: float) -> bool:
            pose[:2] = target + away * distance
            return self._touches(thing)

        pose[:2] = target + away * _last_free(at, 0.7)

    def _lowest(self, thing: int) -> float:
        """The lowest point of a thing's bounding boxes [m]; for what stands off the table."""
        mujoco.mj_kinematics(self.model, self.data)
        geoms = np.flatnonzero(self.model.geom_bodyid == thing + 1)
        middle, half = self.model.geom_aabb[geoms, :3], self.model.geom_aabb[geoms, 3:]
        rotation = self.data.geom_xmat[geoms].reshape(-1, 3, 3)
        centre = self.data.geom_xpos[geoms] + np.einsum("nij,nj->ni", rotation, middle)
        reach = np.einsum("nij,nj->ni", np.abs(rotation), half)
        return float((centre - reach)[:, 2].min())

    def _touches(self, thing: int) -> bool:
        mujoco.mj_kinematics(self.model, self.data)
        mujoco.mj_comPos(self.model, self.data)
        mujoco.mj_collision(self.model, self.data)
        bodies = self.model.geom_bodyid[self.data.contact.geom]
        return bool((bodies == thing + 1).any())


def _last_free(touches: Callable[[float], bool], start: float) -> float:
    """The least distance, coming from `start`, before anything touches."""
    free = start
    while free > 0 and not touches(free - _STEP_M):
        free -= _STEP_M
    taken = free - _STEP_M
    while free - taken > _FINE_M:
        middle = (free + taken) / 2
        free, taken = (free, middle) if touches(middle) else (middle, taken)
    return free


def _turn(rng: np.random.Generator) -> NDArray[np.float64]:
    """Mostly upright, else on a side or upside down; turned about the vertical at will."""
    upright = np.array([1.0, 0, 0, 0])
    if rng.random() < 0.3:
        angle = rng.choice([0.5, 1.0, 1.5]) * math.pi
        axis = rng.integers(1, 3)
        upright = np.zeros(4)
        upright[0], upright[axis] = math.cos(angle / 2), math.sin(angle / 2)
    yaw = rng.uniform(-math.pi, math.pi)
    turned = np.zeros(4)
    mujoco.mju_mulQuat(turned, np.array([math.cos(yaw / 2), 0, 0, math.sin(yaw / 2)]), upright)
    return turned


def _view(rng: np.random.Generator) -> View:
    elevation, azimuth = rng.uniform(0.4, 1.2), rng.uniform(-math.pi, math.pi)
    distance = rng.uniform(0.75, 1.6)
    away = np.array(
        [
            math.cos(azimuth) * math.cos(elevation),
            math.sin(azimuth) * math.cos(elevation),
            math.sin(elevation),
        ]
    )
    target = np.array([*rng.uniform(-0.1, 0.1, 2), 0.05])
    return look_at(target + distance * away, target, *_SIZE, _FOVY_RAD)


def _seen(depth_m: NDArray[np.float32], rng: np.random.Generator) -> NDArray[np.float32]:
    """With the faults of a Kinect."""
    return kinect_noise(depth_m, rng)
