"""Placement of things on a table until they touch something, without physics."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import product

import mujoco
import numpy as np
from numpy.typing import NDArray

from semmap.nodes.sim_node.models.library import Model
from semmap.nodes.sim_node.physics.build import add_part

_HIGHEST_M = 0.42  # of a tower
_PARKED_M = 20.0
_HIGH_M, _LEG_M = 0.7, 0.06
_WOOD = (0.7, 0.6, 0.5, 1.0)
_STEP_M, _FINE_M = 0.02, 0.0005


class Tabletop:
    """A table with its top at z = 0, and the things beside it that are not placed yet."""

    def __init__(self, models: list[Model], half_m: tuple[float, float] = (1.0, 1.0)) -> None:
        """`half_m`: half the table's extents along x and y."""
        self._half_m = np.array(half_m)
        spec = mujoco.MjSpec()
        spec.worldbody.add_light(pos=[0.5, -1.0, 3.0])
        x, y = half_m
        leg = _LEG_M / 2
        boxes = [((x, y, 0.02), (0.0, 0.0, -0.02))]
        for at_x, at_y in product((leg - x, x - leg), (leg - y, y - leg)):
            boxes.append(((leg, leg, _HIGH_M / 2), (at_x, at_y, -_HIGH_M / 2 - 0.02)))
        for size, pos in boxes:
            spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=size, pos=pos, rgba=_WOOD)
        for number, model in enumerate(models):
            body = spec.worldbody.add_body(pos=[_PARKED_M + number, 0, 1])
            body.add_freejoint()
            body.explicitinertial, body.mass, body.inertia = True, 1.0, [0.01, 0.01, 0.01]
            for part in model.parts:
                add_part(body, part)
        self.model = spec.compile()
        self.data = mujoco.MjData(self.model)

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
        on_table = bool((np.abs(spot) < self._half_m).all())

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
