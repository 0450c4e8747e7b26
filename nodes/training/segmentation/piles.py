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
from nodes.sim_node.models.parts import ALONG_X, box, rod
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
_SCREENED = 0.2  # of the piles
_FAULTLESS = 0.2  # of the piles are seen without the faults of a Kinect
_PLAIN = 0.4  # of the things are mere boxes and cylinders: packets and tins
_SIZE = (640, 480)
_FOVY_RAD = 2 * math.atan(240 / 525)
_PARKED_M = 20.0
_STEP_M, _FINE_M = 0.02, 0.0005
_FOCAL_BASELINE_PX_M, _NEAREST_M = 525.0 * 0.075, 0.3
_SHADOW_MARGIN_PX = 1.0


class Pile(NamedTuple):
    """What the camera saw, and (H, W) the number of the thing at each pixel, 0 for the table."""

    cloud: Cloud
    truth: NDArray[np.int32]


def pile(rng: np.random.Generator, eye: Eye) -> Pile:
    """A table with 2 to 14 things on it; in some a long one is hidden in its middle by another."""
    models = [_thing(rng) for _ in range(int(rng.integers(2, 15)))]
    screened = rng.random() < _SCREENED
    if screened:
        models[:2] = _long_and_narrow(rng)
    scene = _Scene(models)
    view = _view(rng)
    eye_m = view.map_from_camera[:2, 3]
    area = rng.uniform(0.15, 0.45)
    if screened:
        scene.screen(0, 1, eye_m, rng)
    for thing in range(2 if screened else 0, len(models)):
        scene.place(thing, area, eye_m, rng)
    mujoco.mj_forward(scene.model, scene.data)
    rgb, depth_m = eye.see(scene.model, scene.data, view)
    geom = eye.segment(scene.model, scene.data, view)
    body = np.where(geom >= 0, scene.model.geom_bodyid[geom], 0)
    if rng.random() > _FAULTLESS:
        depth_m = kinect_noise(np.where(shadowed(depth_m), np.float32(0), depth_m), rng)
    cloud = Cloud(back_project(depth_m, view.intrinsics), rgb, None, view.intrinsics)
    return Pile(cloud, np.where(depth_m > 0, body, 0).astype(np.int32))


def _thing(rng: np.random.Generator) -> Model:
    """A thing of the library at some size, or a plain box or cylinder."""
    if rng.random() < _PLAIN:
        x, y, z = np.exp(rng.uniform(np.log(0.03), np.log(0.26), 3)).tolist()
        return _plain((x, y, z), rng)
    name = str(rng.choice(_KINDS))
    size = np.array(MODELS[name].size_m) * rng.uniform(0.7, 1.25) * rng.uniform(0.85, 1.15, 3)
    return build(name, tuple(float(side) for side in np.clip(size, 0.005, 0.5)))


def _long_and_narrow(rng: np.random.Generator) -> tuple[Model, Model]:
    """A plain thing that lies along x, and one to stand in front of it."""
    length = rng.uniform(0.14, 0.36)
    side, height = rng.uniform(0.04, 0.12, 2)
    narrow = rng.uniform(0.03, 0.4 * length)
    tall = rng.uniform(0.6, 1.5) * height + 0.04
    return _plain((length, side, height), rng), _plain((narrow, narrow, tall), rng)


def _plain(size_m: tuple[float, float, float], rng: np.random.Generator) -> Model:
    x, y, z = size_m
    red, green, blue = rng.uniform(0.1, 0.9, 3).tolist()
    round_ = rng.random() < 0.4
    lying = x > z
    if round_ and lying:
        part = rod(z / 2, x, (0.0, 0.0, z / 2), (red, green, blue), ALONG_X)
    elif round_:
        part = rod(x / 2, z, (0.0, 0.0, z / 2), (red, green, blue))
    else:
        part = box((x, y, z), (0.0, 0.0, z / 2), (red, green, blue))
    return assemble("plain", [part], 0.5)


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

    def screen(self, far: int, near: int, eye_m: NDArray[np.float64], rng: np.random.Generator) -> None:
        """Put a long thing across the view, and another one between it and the eye."""
        away = eye_m / np.linalg.norm(eye_m)
        yaw = math.atan2(away[1], away[0]) + math.pi / 2 + rng.normal(0, 0.4)
        pose = self.data.qpos[7 * far : 7 * far + 7]
        pose[3:] = (math.cos(yaw / 2), 0, 0, math.sin(yaw / 2))
        self._lower(far, rng.uniform(-0.1, 0.1, 2))
        along = rng.normal(0, 0.03) * np.array([math.cos(yaw), math.sin(yaw)])
        target = pose[:2] + along
        self._lower(near, target + away * (_PARKED_M / 2))
        self._slide(near, target, away, self.data.qpos[7 * near + 2])
        self.data.qpos[7 * near : 7 * near + 2] += away * rng.uniform(0.0, 0.15)

    def place(self, thing: int, area_m: float, eye_m: NDArray[np.float64], rng: np.random.Generator) -> None:
        """Put a thing on the table, on top of one before it, between one and the eye, or beside one."""
        pose = self.data.qpos[7 * thing : 7 * thing + 7]
        pose[3:] = _turn(rng)
        way = rng.random() if thing else 0.0
        spot = rng.uniform(-area_m, area_m, 2)
        if way < 0.25:
            self._lower(thing, spot)
            return
        other = int(rng.integers(thing))
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


def shadowed(depth_m: NDArray[np.float32]) -> NDArray[np.bool_]:
    """(H, W) what a Kinect's projector does not light, because something nearer is in its way.

    A pixel's disparity says in which of the projector's columns it is. A row's columns rise from left to
    right, but for what is behind: it shares its column with something farther right.
    """
    disparity = _FOCAL_BASELINE_PX_M / np.maximum(depth_m, _NEAREST_M)
    column = np.where(depth_m > 0, np.arange(depth_m.shape[1]) - disparity, np.inf)
    lowest_right = np.minimum.accumulate(column[:, ::-1], axis=1)[:, ::-1]
    return (depth_m > 0) & (column > lowest_right + _SHADOW_MARGIN_PX)
