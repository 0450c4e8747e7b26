"""Made-up scenes: things on a table, apart, side by side and on one another, seen by a depth camera."""

from __future__ import annotations

import math
from typing import NamedTuple

import mujoco
import numpy as np
from numpy.typing import NDArray

from nodes.perception_node.cloud import Cloud
from nodes.perception_node.projection import cloud_of
from nodes.sim_node.models.library import Model, assemble, build
from nodes.sim_node.models.parts import ALONG_X, box, rod
from nodes.sim_node.models.table import MODELS
from nodes.sim_node.vision.camera import Eye
from nodes.sim_node.vision.noise import kinect_noise
from nodes.sim_node.vision.view import View, look_at
from nodes.training.segmentation.shadow import shadowed
from nodes.training.segmentation.tabletop import Tabletop

_BIGGEST_M, _SMALLEST_M = 0.36, 0.03
_KINDS = tuple(
    name
    for name, kind in MODELS.items()
    if max(kind.size_m) <= _BIGGEST_M and sorted(kind.size_m)[1] >= _SMALLEST_M
)
_SCREENED = 0.2  # of the piles
_FAULTLESS = 0.2  # of the piles are seen without the faults of a Kinect
_PLAIN = 0.4  # of the things are mere boxes and cylinders: packets and tins
_GREY = (0.5, 0.5, 0.5)
_SIZE = (640, 480)
_FOVY_RAD = 2 * math.atan(240 / 525)


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
    scene = Tabletop(models)
    view = _view(rng)
    eye_m = view.map_from_camera[:2, 3]
    area = rng.uniform(0.15, 0.45)
    if screened:
        scene.screen(0, 1, eye_m, rng)
    for thing in range(2 if screened else 0, len(models)):
        scene.place(thing, area, eye_m, rng)
    mujoco.mj_forward(scene.model, scene.data)
    _, depth_m = eye.see(scene.model, scene.data, view)
    geom = eye.segment(scene.model, scene.data, view)
    body = np.where(geom >= 0, scene.model.geom_bodyid[geom], 0)
    if rng.random() > _FAULTLESS:
        depth_m = kinect_noise(np.where(shadowed(depth_m), np.float32(0), depth_m), rng)
    cloud = cloud_of(depth_m, None, view.intrinsics)
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
    round_ = rng.random() < 0.4
    lying = x > z
    if round_ and lying:
        part = rod(z / 2, x, (0.0, 0.0, z / 2), _GREY, ALONG_X)
    elif round_:
        part = rod(x / 2, z, (0.0, 0.0, z / 2), _GREY)
    else:
        part = box((x, y, z), (0.0, 0.0, z / 2), _GREY)
    return assemble("plain", [part], 0.5)


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
