"""Generated scenes: things on a table, apart, side by side and stacked, seen by a depth camera."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import mujoco
import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.input.projection import cloud_of
from semmap.nodes.sim_node.models.library import Model, assemble
from semmap.nodes.sim_node.models.model_table import MODELS
from semmap.nodes.sim_node.models.parts import ALONG_X, Colour, Vec3, box, rod
from semmap.nodes.sim_node.vision.camera import Eye
from semmap.nodes.sim_node.vision.noise import kinect_noise
from semmap.nodes.sim_node.vision.view import View, look_at
from semmap.nodes.training.segmentation.tabletop import Tabletop

_BIGGEST_M, _SMALLEST_M = 0.52, 0.03
_KINDS = tuple(
    name
    for name, kind in MODELS.items()
    if max(kind.size_m) <= _BIGGEST_M and sorted(kind.size_m)[1] >= _SMALLEST_M
)
_HALF_TABLE_M = (0.45, 1.2)
_SCREENED = 0.2  # of the piles
_FAULTLESS = 0.2  # of the piles are seen without the faults of a Kinect
_PLAIN = 0.4  # of the things are mere boxes and cylinders: packets and tins
_PLACED = 0.5  # of the piles are seen by a camera that knows where it is
_COLOURLESS = 0.2  # of the piles are seen without colours
_ALIKE = 0.25  # of the piles are of things of one colour
_REPAINTED = 0.5  # of the other things have a colour of their own, not the library's
_BANDED = 0.4  # of the plain things have two
_COLOUR_NOISE = 8.0
_SIZE = (640, 480)
_FOVY_RAD = 2 * math.atan(240 / 525)
Tints = Callable[[], Colour | None]
"""Returns the colour of the next thing; None for the library's."""
_FOCAL_BASELINE_PX_M, _NEAREST_M = 525.0 * 0.075, 0.3
_MARGIN_PX = 1.0


class Pile(NamedTuple):
    """The camera's frame, and (H, W) the number of the thing at each pixel, 0 for the table."""

    cloud: Cloud
    truth: NDArray[np.int32]


def pile(rng: np.random.Generator, eye: Eye) -> Pile:
    """Return a table with 2 to 14 things; in some scenes the middle of a long one is hidden."""
    tints = _tints(rng)
    models = [_thing(tints, rng) for _ in range(int(rng.integers(2, 15)))]
    screened = rng.random() < _SCREENED
    if screened:
        models[:2] = _long_and_narrow(tints, rng)
    x, y = rng.uniform(*_HALF_TABLE_M, 2).tolist()
    scene = Tabletop(models, (x, y))
    view = _view(rng)
    eye_m = view.map_from_camera[:2, 3]
    area = rng.uniform(0.15, min(0.45, x, y))
    if screened:
        scene.screen(0, 1, eye_m, rng)
    for thing in range(2 if screened else 0, len(models)):
        scene.place(thing, area, eye_m, rng)
    mujoco.mj_forward(scene.model, scene.data)
    rgb, depth_m = eye.render(scene.model, scene.data, view)
    geom = eye.segment(scene.model, scene.data, view)
    body = np.where(geom >= 0, scene.model.geom_bodyid[geom], 0)
    if rng.random() > _FAULTLESS:
        depth_m = kinect_noise(np.where(shadowed(depth_m), np.float32(0), depth_m), rng)
    pose = view.map_from_camera if rng.random() < _PLACED else None
    cloud = cloud_of(depth_m, _photographed(rgb, rng), view.intrinsics, pose)
    return Pile(cloud, np.where(depth_m > 0, body, 0).astype(np.int32))


def _tints(rng: np.random.Generator) -> Tints:
    if rng.random() < _ALIKE:
        shared = _any_colour(rng)
        return lambda: shared
    return lambda: _any_colour(rng) if rng.random() < _REPAINTED else None


def _any_colour(rng: np.random.Generator) -> Colour:
    red, green, blue = rng.uniform(0.05, 0.95, 3).tolist()
    return red, green, blue


def _photographed(rgb: NDArray[np.uint8], rng: np.random.Generator) -> NDArray[np.uint8] | None:
    """Return an image like a cheap camera's: with random light and noise; or none."""
    if rng.random() < _COLOURLESS:
        return None
    noise = rng.normal(0.0, _COLOUR_NOISE * rng.random(), rgb.shape)
    return np.clip(rgb * rng.uniform(0.6, 1.2) * rng.uniform(0.85, 1.15, 3) + noise, 0, 255).astype(np.uint8)


def _thing(tints: Tints, rng: np.random.Generator) -> Model:
    """A thing of the library at some size, or a plain box or cylinder."""
    if rng.random() < _PLAIN:
        x, y, z = np.exp(rng.uniform(np.log(0.03), np.log(0.26), 3)).tolist()
        return _plain((x, y, z), tints, rng)
    kind = MODELS[name := str(rng.choice(_KINDS))]
    size = np.array(kind.size_m) * rng.uniform(0.7, 1.25) * rng.uniform(0.85, 1.15, 3)
    x, y, z = np.clip(size, 0.005, 0.6).tolist()
    return assemble(name, kind.parts(x, y, z, tints() or kind.colour), kind.mass_kg)


def _long_and_narrow(tints: Tints, rng: np.random.Generator) -> tuple[Model, Model]:
    """A plain thing that lies along x, and one to stand in front of it."""
    length = rng.uniform(0.14, 0.36)
    side, height = rng.uniform(0.04, 0.12, 2)
    narrow = rng.uniform(0.03, 0.4 * length)
    tall = rng.uniform(0.6, 1.5) * height + 0.04
    return _plain((length, side, height), tints, rng), _plain((narrow, narrow, tall), tints, rng)


def _plain(size_m: Vec3, tints: Tints, rng: np.random.Generator) -> Model:
    """A packet or a tin; printed ones have a lower half of another colour."""
    x, y, z = size_m
    colour = tints() or _any_colour(rng)
    lower = _any_colour(rng) if rng.random() < _BANDED else colour
    round_ = rng.random() < 0.4
    lying = x > z
    if round_ and lying:
        halves = [
            rod(z / 2, x / 2, (along, 0.0, z / 2), tint, ALONG_X)
            for along, tint in ((-x / 4, lower), (x / 4, colour))
        ]
    elif round_:
        halves = [rod(x / 2, z / 2, (0.0, 0.0, up), tint) for up, tint in _halved(z, lower, colour)]
    else:
        halves = [box((x, y, z / 2), (0.0, 0.0, up), tint) for up, tint in _halved(z, lower, colour)]
    return assemble("plain", halves, 0.5)


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


def _halved(height_m: float, lower: Colour, upper: Colour) -> tuple[tuple[float, Colour], ...]:
    """The middles of both halves, and their colours."""
    return ((height_m / 4, lower), (3 * height_m / 4, upper))


def shadowed(depth_m: NDArray[np.float32]) -> NDArray[np.bool_]:
    """Return which pixels (H, W) a Kinect's projector does not light, because an object occludes them.

    The disparity of a pixel determines its column of the projector. Along a row, columns increase from left
    to right, except for an occluded pixel: it shares its column with a pixel farther right.
    """
    disparity = _FOCAL_BASELINE_PX_M / np.maximum(depth_m, _NEAREST_M)
    column = np.where(depth_m > 0, np.arange(depth_m.shape[1]) - disparity, np.inf)
    lowest_right = np.minimum.accumulate(column[:, ::-1], axis=1)[:, ::-1]
    return (depth_m > 0) & (column > lowest_right + _MARGIN_PX)
