"""Distractors: random compositions of solids without a class, from which perception learns `Object`.

Many are mirror-symmetric, like most manufactured things.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from scipy.spatial import ConvexHull

from semmap.nodes.sim_node.models.forms import shifted
from semmap.nodes.sim_node.models.model_files import keyed
from semmap.nodes.sim_node.models.parts import (
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
from semmap.nodes.sim_node.models.parts import product as rotated
from semmap.nodes.training.scenes.solids import Solid, full, lathe, smooth, tube

_SMALLEST_M, _LARGEST_M = 0.035, 0.32
_MOST_PARTS = 5
_MIRRORED, _LUMPS = 0.35, 0.15
_NEARLY = 0.88
_THINNEST = 0.25
"""The minimum height of a truncated lump, in radii; flatter ones have no convex hull."""


def distractor_parts(rng: np.random.Generator, colour: Colour) -> Parts:
    """Return one lump, or two to five touching solids, on the ground and centred at the origin."""
    parts = _random_parts(rng, colour)
    while _is_plain(parts):
        parts = _random_parts(rng, colour)
    parts = keyed(parts, f"strange {rng.integers(1 << 62)}")
    low, high = bounds(parts)
    middle = (low + high) / 2.0
    return shifted(parts, x=-float(middle[0]), y=-float(middle[1]), z=-float(low[2]))


def _random_parts(rng: np.random.Generator, colour: Colour) -> Parts:
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
        parts += [_mirrored(part) for part in parts]
    return parts


def _is_plain(parts: Parts) -> bool:
    """Return whether one box, ball or rod makes up nearly all of it, like a carton, a ball or a can."""
    low, high = bounds(parts)
    return any(part.mesh is None and (2.0 * part.reach() > _NEARLY * (high - low)).all() for part in parts)


def size_of(parts: Parts) -> Vec3:
    """Return the extents of the bounding box of all parts [m]."""
    low, high = bounds(parts)
    return _vec3(high - low)


def _solid(size_m: float, at: Vec3, colour: Colour, rng: np.random.Generator) -> Part:
    shade = np.clip(np.array(colour) * np.exp(rng.normal(0.0, 0.4)) + rng.normal(0.0, 0.1, 3), 0.02, 1.0)
    tint = _vec3(shade)
    x, y, z = (size_m * np.exp(rng.normal(-0.3, 0.5, 3))).clip(0.012, 0.4).tolist()
    turn = about("z", float(rng.uniform(-math.pi, math.pi)))
    if rng.random() < 0.4:
        turn = rotated(turn, about("y", float(rng.choice([math.pi / 2, rng.uniform(-1.2, 1.2)]))))
    kind = rng.choice(
        ["box", "ball", "rod", "pill", "lump", "turned", "bow"], p=[0.3, 0.1, 0.2, 0.12, 0.08, 0.1, 0.1]
    )
    if kind == "lump":
        return _lump(size_m, at, tint, rng)
    if kind in ("turned", "bow"):
        solid = (_turned if kind == "turned" else _bow)(size_m, rng)
        return (
            solid.turned(
                str(rng.choice(["x", "y"])), float(rng.choice([0.0, math.pi / 2, rng.uniform(-1.0, 1.0)]))
            )
            .moved(*at)
            .part(tint)
        )
    if kind == "box":
        return box((x, y, z), at, tint, turn)
    if kind == "ball":
        return ball((x, y, z), at, tint, turn)
    return (rod if kind == "rod" else pill)(x / 2, max(z, 1.1 * x), at, tint, turn)


def _lump(size_m: float, at: Vec3, colour: Colour, rng: np.random.Generator) -> Part:
    """Return the hull of points on a scaled ball, mostly truncated below: pebbles, wedges, computer mice."""
    points = rng.normal(size=(int(rng.integers(8, 60)), 3))
    points /= np.linalg.norm(points, axis=1)[:, None]
    points[:, 2] = np.maximum(points[:, 2], min(rng.uniform(-1.0, 0.1), points[:, 2].max() - _THINNEST))
    hull = ConvexHull(points * 0.5 * size_m * np.exp(rng.normal(-0.2, 0.35, 3)))
    outward = np.cross(
        *(hull.points[hull.simplices[:, n]] - hull.points[hull.simplices[:, 0]] for n in (1, 2))
    )
    turned = (outward * hull.equations[:, :3]).sum(axis=1) < 0.0
    faces = np.where(turned[:, None], hull.simplices[:, ::-1], hull.simplices)
    return mesh(hull.points + at, faces, colour)


def _turned(size_m: float, rng: np.random.Generator) -> Solid:
    """Return a solid of revolution with a random profile, like a knob, a torch or a bulb."""
    count = int(rng.integers(3, 7))
    radii = 0.5 * size_m * rng.uniform(0.15, 1.0, count) * np.exp(rng.normal(-0.3, 0.3))
    heights = np.sort(rng.uniform(-0.5, 0.5, count)) * size_m
    profile = list(zip(radii.tolist(), heights.tolist(), strict=True))
    return lathe(full(smooth(profile) if rng.random() < 0.6 else profile), slices=14)


def _bow(size_m: float, rng: np.random.Generator) -> Solid:
    """Return a ring or a part of one, like clamps, hooks and toys."""
    around = np.linspace(0.0, float(rng.uniform(0.5, 1.9)) * math.pi, 18)
    path = (
        0.5 * size_m * np.column_stack([np.cos(around), rng.uniform(0.5, 1.0) * np.sin(around), 0.0 * around])
    )
    return tube(path, size_m * float(rng.uniform(0.05, 0.2)), slices=8)


def _mirrored(part: Part) -> Part:
    """Return a part mirrored at the plane x = 0."""
    x, y, z = part.centre
    if part.mesh is not None:
        vertices = (part.mesh.vertices + part.centre) * (-1.0, 1.0, 1.0)
        return mesh(vertices, part.mesh.faces[:, ::-1], part.colour)
    w, i, j, k = part.turn
    return replace(part, centre=(-x, y, z), turn=(w, i, -j, -k))


def _vec3(values: np.ndarray) -> Vec3:
    return (float(values[0]), float(values[1]), float(values[2]))
