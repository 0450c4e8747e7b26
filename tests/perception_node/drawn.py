"""A room drawn by ray casting: a floor, a wall, a table with a few things, and what cameras measure of it.

Depth has normally distributed noise of a millimetre at a metre, which grows with the square of the distance.
"""

import json
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from semmap.nodes.perception_node.input.cloud import Cloud

WIDTH, HEIGHT, FOCAL = 320, 240, 300.0
INTRINSICS = np.array([[FOCAL, 0.0, WIDTH / 2], [0.0, FOCAL, HEIGHT / 2], [0.0, 0.0, 1.0]])
NOISE_M = 0.001
BOXES = (  # low and high corner [m], colour
    ((-2.0, -3.0, -0.1), (3.0, 3.0, 0.0), (120, 110, 100)),  # floor
    ((2.0, -3.0, 0.0), (2.1, 3.0, 2.5), (230, 230, 225)),  # wall
    ((-0.3, -0.6, 0.66), (0.5, 0.6, 0.70), (150, 100, 60)),  # table top
    ((-0.25, -0.55, 0.0), (-0.2, -0.5, 0.66), (150, 100, 60)),
    ((0.4, 0.5, 0.0), (0.45, 0.55, 0.66), (150, 100, 60)),
    ((0.0, -0.35, 0.70), (0.1, -0.25, 0.95), (200, 30, 30)),  # carton
    ((0.12, -0.34, 0.70), (0.22, -0.2, 0.80), (30, 60, 200)),  # box behind it
    ((-0.1, 0.25, 0.70), (0.12, 0.42, 0.712), (240, 240, 240)),  # thin book
    ((0.7, -1.4, 0.0), (1.1, -1.0, 0.45), (90, 160, 90)),  # box on the floor
)
BALLS = (((0.05, 0.05, 0.745), 0.045, (230, 140, 20)), ((0.2, 0.5, 0.75), 0.05, (220, 40, 40)))
EYES = {"left": (-1.0, 0.3, 1.35), "right": (-0.6, -0.9, 1.3)}


def pose_of(eye, target=(0.15, 0.0, 0.7)):
    """Return map_from_camera (4, 4) of a level camera that looks at a point."""
    forward = np.subtract(target, eye)
    forward = forward / np.linalg.norm(forward)
    right = np.cross(forward, (0.0, 0.0, 1.0))
    right /= np.linalg.norm(right)
    pose = np.eye(4)
    pose[:3, :3] = np.stack([right, np.cross(forward, right), forward], axis=1)
    pose[:3, 3] = eye
    return pose


@cache
def cloud(camera="left", scale=1, *, noise_m=NOISE_M, known=True):
    """Return what a camera sees; `scale` multiplies the resolution."""
    pose = pose_of(EYES[camera])
    row, column = np.indices((HEIGHT * scale, WIDTH * scale)) + 0.5
    intrinsics = INTRINSICS * scale
    intrinsics[2, 2] = 1.0
    rays = np.stack(
        [column - intrinsics[0, 2], row - intrinsics[1, 2], np.full(row.shape, FOCAL * scale)], -1
    )
    rays = rays / rays[..., 2:]
    turned, eye = rays @ pose[:3, :3].T, pose[:3, 3]
    depth, shade = np.full(row.shape, np.inf), np.zeros((*row.shape, 3), np.uint8)
    for near, colour in (*_boxes(turned, eye), *_balls(turned, eye)):
        closer = near < depth
        depth[closer], shade[closer] = near[closer], colour
    dice = np.random.default_rng(7)
    depth = (
        depth + noise_m * dice.standard_normal(depth.shape) * np.where(np.isfinite(depth), depth, 0.0) ** 2
    )
    depth[~np.isfinite(depth) | (dice.random(depth.shape) < 0.01)] = np.nan
    points = (rays * depth[..., None]).astype(np.float32)
    return Cloud(points, shade, pose if known else None, intrinsics, camera, 1_000)


def _boxes(turned, eye):
    for low, high, colour in BOXES:
        with np.errstate(divide="ignore", invalid="ignore"):
            one, other = ((np.array(side) - eye) / turned for side in (low, high))
        enter, leave = np.minimum(one, other).max(axis=-1), np.maximum(one, other).min(axis=-1)
        yield np.where((enter < leave) & (enter > 0), enter, np.inf), colour


def _balls(turned, eye):
    for centre, radius, colour in BALLS:
        off = eye - np.array(centre)
        a, b, c = (turned**2).sum(-1), turned @ off, off @ off - radius**2
        root = b * b - a * c
        with np.errstate(invalid="ignore"):
            yield np.where(root > 0, (-b - np.sqrt(root)) / a, np.inf), colour


def summary(values):
    """Return shape, number of finite values, mean, spread, and a few values of an array."""
    array = np.asarray(values, float)
    finite = array[np.isfinite(array)]
    some = array.ravel()[:: max(1, array.size // 5)][:5]
    mean, spread = (finite.mean(), finite.std()) if finite.size else (0.0, 0.0)
    rest = [round(float(value), 5) if np.isfinite(value) else None for value in (mean, spread, *some)]
    return [*array.shape, int(finite.size), *rest]


def counts(labels):
    """Return how many pixels each label has."""
    return np.bincount(np.asarray(labels).ravel()).tolist()


def check(found, file):
    """Compare named lists of numbers with those of a JSON file, within half a percent."""
    expected = json.loads(Path(file).read_text())
    assert found.keys() == expected.keys()
    for name, values in found.items():
        assert len(values) == len(expected[name]), name
        for at, (value, wanted) in enumerate(zip(values, expected[name], strict=True)):
            if wanted is None or isinstance(wanted, str):
                assert value == wanted, (name, at)
            else:
                assert value == pytest.approx(wanted, rel=0.005, abs=2e-4), (name, at)
