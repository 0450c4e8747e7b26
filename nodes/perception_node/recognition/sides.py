"""Estimates the sides of the complete thing from those of its visible part."""

from __future__ import annotations

import numpy as np

from semmap.nodes.perception_node.recognition.perceptron import Perceptron
from semmap.nodes.perception_node.views.boxes import Box, Numbers, in_frame
from semmap.nodes.perception_node.views.merged_thing import Thing

SIZE_FEATURES = slice(-3, None)
"""The columns of the features with the expected size."""

_NEAR = 0.12
_LEAST_M = 0.002


def side_features(thing: Thing, expected_m: Numbers) -> Numbers:
    """Return features (5, F) of the sides -x, +x, -y, +y of the visible box, and of its top.

    `expected_m` (3,): long side, short side and height of things of its likely classes.
    """
    size, height = thing.box.size_m, thing.box.size_m[2]
    middle = (thing.box.low + thing.box.high) / 2
    to_eye = in_frame(thing.eyes, thing.box.yaw_rad) - middle
    level = to_eye[:, :2] / (np.linalg.norm(to_eye[:, :2], axis=1, keepdims=True) + 1e-9)
    steep = float((to_eye[:, 2] / np.linalg.norm(to_eye, axis=1)).max())
    distance = float(np.linalg.norm(to_eye, axis=1).min())
    cells = in_frame(thing.cells, thing.box.yaw_rad)
    inside = np.clip((cells - thing.box.low) / size, 0.0, 1.0)
    scale = _scale(thing)
    common = [
        steep,
        distance,
        len(thing.eyes) - 1.0,
        np.log(scale),
        height / scale,
        thing.lifted_m / scale,
        float(not thing.whole),
        *np.log(expected_m / scale),
    ]
    rows = []
    for axis in (0, 1):
        along, across = size[axis] / scale, size[1 - axis] / scale
        for sign in (-1.0, 1.0):
            facing = sign * level[:, axis]
            depth = inside[:, axis] if sign < 0 else 1.0 - inside[:, axis]
            rows.append(
                [
                    float(facing.max()),
                    float(-facing.min()),
                    along,
                    across,
                    *_end(inside, depth, 1 - axis),
                    *_end(inside, 1.0 - depth, 1 - axis),
                    *common,
                ]
            )
    top = [float(level[:, 0].max()), 0.0, size[0] / scale, size[1] / scale]
    ends = [*_end(inside, 1.0 - inside[:, 2], 0), *_end(inside, inside[:, 2], 0)]
    rows.append([*top, *ends, *common])
    return np.array(rows)


def _end(inside: Numbers, depth: Numbers, across: int) -> tuple[float, float, float, float]:
    """Return the share of cells near one end, the width there, and the lowest and mean height."""
    near = depth < _NEAR
    if not near.any():
        return (0.0, 0.0, 1.0, 1.0)
    part = inside[near]
    return (
        float(near.mean()),
        float(np.ptp(part[:, across])),
        float(part[:, 2].min()),
        float(part[:, 2].mean()),
    )


def _scale(thing: Thing) -> float:
    return float(max(thing.box.size_m[:2].mean(), 0.02))


def completed(thing: Thing, features: Numbers, regressor: Perceptron) -> Box:
    """Return the box of the complete thing: each side of the visible box is moved outwards."""
    shift = regressor(features)[:, 0] * _scale(thing)
    low = thing.box.low - [shift[0], shift[2], 0.0]
    high = thing.box.high + shift[[1, 3, 4]]
    middle, half = (low + high) / 2, np.maximum(high - low, _LEAST_M) / 2
    middle[2] = low[2] + half[2]
    return Box(middle - half, middle + half, thing.box.yaw_rad)


def shifts(thing: Thing, truth: Box) -> Numbers:
    """Return (5,) how far each side must move to match `truth`, a box of the same yaw; see `completed`."""
    low, high = thing.box.low - truth.low, truth.high - thing.box.high
    return np.array([low[0], high[0], low[1], high[1], high[2]]) / _scale(thing)
