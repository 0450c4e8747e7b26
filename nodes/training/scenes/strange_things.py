"""Things of no class: a few solids put together by lot. So perception learns to say `Object`."""

from __future__ import annotations

import math

import numpy as np

from nodes.sim_node.models.forms import shifted
from nodes.sim_node.models.parts import Colour, Part, Parts, Vec3, about, ball, bounds, box, pill, rod
from nodes.sim_node.models.parts import product as rotated

_SMALLEST_M, _LARGEST_M = 0.035, 0.32
_MOST_PARTS = 5


def strange_parts(rng: np.random.Generator, colour: Colour) -> Parts:
    """Two to five solids that touch, upon the ground, its middle below the middle of all."""
    size = float(np.exp(rng.uniform(math.log(_SMALLEST_M), math.log(_LARGEST_M))))
    parts: Parts = []
    for n in range(int(rng.integers(2, _MOST_PARTS + 1))):
        at = np.zeros(3)
        if n:
            on = parts[int(rng.integers(n))]
            at = np.asarray(on.centre) + rng.uniform(-0.9, 0.9, 3) * on.reach()
        parts.append(_solid(size * float(rng.uniform(0.3, 1.0)), _vec3(at), colour, rng))
    low, high = bounds(parts)
    middle = (low + high) / 2.0
    return shifted(parts, x=-float(middle[0]), y=-float(middle[1]), z=-float(low[2]))


def size_of(parts: Parts) -> Vec3:
    """What they measure together [m]."""
    low, high = bounds(parts)
    return _vec3(high - low)


def _solid(size_m: float, at: Vec3, colour: Colour, rng: np.random.Generator) -> Part:
    shade = np.clip(np.array(colour) * np.exp(rng.normal(0.0, 0.4)) + rng.normal(0.0, 0.1, 3), 0.02, 1.0)
    tint = _vec3(shade)
    x, y, z = (size_m * np.exp(rng.normal(-0.3, 0.5, 3))).clip(0.012, 0.4).tolist()
    turn = about("z", float(rng.uniform(-math.pi, math.pi)))
    if rng.random() < 0.4:
        turn = rotated(turn, about("y", float(rng.choice([math.pi / 2, rng.uniform(-1.2, 1.2)]))))
    kind = rng.choice(["box", "ball", "rod", "pill"], p=[0.4, 0.15, 0.3, 0.15])
    if kind == "box":
        return box((x, y, z), at, tint, turn)
    if kind == "ball":
        return ball((x, y, z), at, tint, turn)
    return (rod if kind == "rod" else pill)(x / 2, max(z, 1.1 * x), at, tint, turn)


def _vec3(values: np.ndarray) -> Vec3:
    return (float(values[0]), float(values[1]), float(values[2]))
