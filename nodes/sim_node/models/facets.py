"""The surface of a model as triangles, for other renderers."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.sim_node.models.library import Model
from semmap.nodes.sim_node.models.parts import Floats, Joint, Part, Role, Shape, rotation_matrix
from semmap.schemas import errors
from semmap.schemas.scenes import Leaf, Surface

_SLICES = 14
_RINGS = 7


class Facets(NamedTuple):
    """Vertices `points` and unit `normals` (N, 3), and counterclockwise `triangles` (M, 3) of their rows."""

    points: Floats
    normals: Floats
    triangles: NDArray[np.int64]


@lru_cache(maxsize=512)
def surface_of(model: Model) -> Surface:
    """Return all visible parts of a model, in its own frame: the bottom centre, z up."""
    seen = [part for part in model.parts if part.role is not Role.COLLISION]
    pieces = [facets(part) for part in seen]
    counts = [len(piece.points) for piece in pieces]
    colours = np.repeat(np.array([part.colour for part in seen]), counts, axis=0)
    starts = np.cumsum([0, *counts[:-1]])
    triangles = [piece.triangles + start for piece, start in zip(pieces, starts, strict=True)]
    return Surface(
        points=np.concatenate([piece.points for piece in pieces]).astype("<f4").tobytes(),
        normals=np.concatenate([piece.normals for piece in pieces]).astype("<f4").tobytes(),
        colours=np.round(255.0 * colours).astype("u1").tobytes(),
        triangles=np.concatenate(triangles).astype("<u4").tobytes(),
        leaves=tuple(_leaf(leaf.joint, seen, [*starts.tolist(), sum(counts)]) for leaf in model.leaves),
    )


def _leaf(joint: Joint, seen: Sequence[Part], starts: Sequence[int]) -> Leaf:
    """Return the range of contiguous parts that a joint moves.

    `starts` has the first row of each part, and the end.
    """
    rows = [row for row, part in enumerate(seen) if part.joint == joint]
    first, end = (starts[rows[0]], starts[rows[-1] + 1]) if rows else (0, 0)
    return Leaf(
        joint=joint.name,
        kind=joint.kind,
        axis=joint.axis,
        anchor=joint.anchor,
        first=first,
        count=end - first,
    )


def facets(part: Part) -> Facets:
    """Return the surface of one part, in the model's frame."""
    half = np.asarray(part.half)
    match part.shape:
        case Shape.BOX:
            own = _scaled(_box(), half)
        case Shape.ELLIPSOID:
            own = _scaled(_turned(_arc(0.0, 1.0)), half)
        case Shape.CYLINDER:
            own = _scaled(_turned(_CAN), half)
        case Shape.CAPSULE:
            radius, straight = float(half[0]), float(half[2])
            own = _turned(
                np.concatenate([_arc(-straight, radius)[:_RINGS], _arc(straight, radius)[_RINGS - 1 :]])
            )
        case Shape.MESH:
            own = _flat(part)
    rotation = rotation_matrix(part.turn)
    return Facets(own.points @ rotation.T + part.centre, own.normals @ rotation.T, own.triangles)


_CAN = np.array(
    [(0, -1, 0, -1), (1, -1, 0, -1), (1, -1, 1, 0), (1, 1, 1, 0), (1, 1, 0, 1), (0, 1, 0, 1)], dtype=float
)
"""Radius, height, and the components of the normal, from the bottom up."""


def _arc(height: float, radius: float) -> Floats:
    """Return the profile of a ball, (2 * _RINGS - 1, 4)."""
    angle = np.linspace(0.0, np.pi, 2 * _RINGS - 1)
    out, up = np.sin(angle), -np.cos(angle)
    return np.column_stack([radius * out, height + radius * up, out, up])


def _turned(profile: Floats) -> Facets:
    """Return the surface of revolution of a profile (K, 4) about z."""
    angle = np.linspace(0.0, 2.0 * np.pi, _SLICES + 1)
    cos, sin = np.cos(angle)[:, None], np.sin(angle)[:, None]
    radius, height, out, up = profile.T
    level = np.ones_like(cos)
    points = np.stack([cos * radius, sin * radius, level * height], axis=-1).reshape(-1, 3)
    normals = np.stack([cos * out, sin * out, level * up], axis=-1).reshape(-1, 3)
    count = len(profile)
    corner = (np.arange(_SLICES)[:, None] * count + np.arange(count - 1)).ravel()
    lower = np.column_stack([corner, corner + count, corner + 1])
    upper = np.column_stack([corner + 1, corner + count, corner + count + 1])
    return Facets(points, normals, np.concatenate([lower, upper]))


def _box() -> Facets:
    """Return a box with half extents of one and four corners per face, for sharp edges."""
    square = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)], dtype=float)
    points, normals = [], []
    for axis in range(3):
        for side in (-1.0, 1.0):
            face = np.insert(square if side > 0 else square[::-1], 0, side, axis=1)
            points.append(np.roll(face, axis, axis=1))
            normals.append(np.tile(np.roll([side, 0.0, 0.0], axis), (4, 1)))
    corners = 4 * np.arange(6)[:, None, None] + np.array([(0, 1, 2), (0, 2, 3)])
    return Facets(np.concatenate(points), np.concatenate(normals), corners.reshape(-1, 3))


def _flat(part: Part) -> Facets:
    """Return a mesh with separate corners for each triangle."""
    if part.mesh is None:
        raise errors.InternalError("the part is not a mesh")
    corners = part.mesh.vertices[part.mesh.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    return Facets(
        corners.reshape(-1, 3), np.repeat(normals, 3, axis=0), np.arange(3 * len(corners)).reshape(-1, 3)
    )


def _scaled(facets: Facets, half: Floats) -> Facets:
    normals = facets.normals / half
    return Facets(
        facets.points * half, normals / np.linalg.norm(normals, axis=1, keepdims=True), facets.triangles
    )
