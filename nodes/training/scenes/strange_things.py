"""Things of no class: a few solids put together by lot. So perception learns to say `Object`.

Many are alike on both sides, as what people make mostly is.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from scipy.spatial import ConvexHull

from nodes.sim_node.models.forms import shifted
from nodes.sim_node.models.model_files import keyed
from nodes.sim_node.models.parts import (
    Colour,
    Part,
    Parts,
    Vec3,
    about,
    ball,
    bounds,
    box,
    mesh,
    pill,
    rod,
)
from nodes.sim_node.models.parts import product as rotated

_SMALLEST_M, _LARGEST_M = 0.035, 0.32
_MOST_PARTS = 5
_MIRRORED, _LUMPS = 0.35, 0.15


def strange_parts(rng: np.random.Generator, colour: Colour) -> Parts:
    """One lump, or two to five solids that touch, upon the ground, its middle below the middle of all."""
    size = float(np.exp(rng.uniform(math.log(_SMALLEST_M), math.log(_LARGEST_M))))
    alone = rng.random() < _LUMPS
    parts: Parts = [_lump(size, (0.0, 0.0, 0.0), colour, rng)] if alone else []
    for n in range(0 if alone else int(rng.integers(2, _MOST_PARTS + 1))):
        at = np.zeros(3)
        if n:
            on = parts[int(rng.integers(n))]
            at = np.asarray(on.centre) + rng.uniform(-0.9, 0.9, 3) * on.reach()
        parts.append(_solid(size * float(rng.uniform(0.3, 1.0)), _vec3(at), colour, rng))
    if not alone and rng.random() < _MIRRORED:
        parts += [_mirrored(part) for part in parts if part.mesh is None]
    parts = keyed(parts, f"strange {rng.integers(1 << 62)}")
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
    kind = rng.choice(["box", "ball", "rod", "pill", "lump"], p=[0.35, 0.12, 0.28, 0.15, 0.1])
    if kind == "lump":
        return _lump(size_m, at, tint, rng)
    if kind == "box":
        return box((x, y, z), at, tint, turn)
    if kind == "ball":
        return ball((x, y, z), at, tint, turn)
    return (rod if kind == "rod" else pill)(x / 2, max(z, 1.1 * x), at, tint, turn)


def _lump(size_m: float, at: Vec3, colour: Colour, rng: np.random.Generator) -> Part:
    """The hull of points about a ball, squeezed and mostly cut off below: pebbles, wedges, computer mice."""
    points = rng.normal(size=(int(rng.integers(8, 60)), 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    points[:, 2] = np.maximum(points[:, 2], rng.uniform(-1.0, 0.1))
    hull = ConvexHull(points * 0.5 * size_m * np.exp(rng.normal(-0.2, 0.35, 3)))
    outward = np.cross(
        *(hull.points[hull.simplices[:, n]] - hull.points[hull.simplices[:, 0]] for n in (1, 2))
    )
    turned = (outward * hull.equations[:, :3]).sum(axis=1) < 0.0
    faces = np.where(turned[:, None], hull.simplices[:, ::-1], hull.simplices)
    return mesh(hull.points + at, faces, colour)


def _mirrored(part: Part) -> Part:
    """On the other side of the plane x = 0."""
    w, i, j, k = part.turn
    x, y, z = part.centre
    return replace(part, centre=(-x, y, z), turn=(w, i, -j, -k))


def _vec3(values: np.ndarray) -> Vec3:
    return (float(values[0]), float(values[1]), float(values[2]))
