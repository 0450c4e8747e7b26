"""The shape of a model, stretched to the size of an entity."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache
from operator import mul

import numpy as np
from msgspec import structs
from numpy.typing import NDArray

from semmap.ontology.model_shapes import ConvexPart, Interior, LeafShape, ModelShape, Surface, shape_named
from semmap.schemas.entities import Size, Vector


@lru_cache(maxsize=8192)
def fit_model(model: str, size: Size) -> ModelShape:
    """Return the shape of a model stretched to a size. Without a model it is the whole box."""
    own = model_shape(model)
    if own is None:
        return box(size)
    if need_quarter_turn(own, np.array([size]))[0]:
        own = turn_quarter(own)
    if own.size_m == size:
        return own
    fx, fy, fz = (mine / its for mine, its in zip(size, own.size_m, strict=True))

    def stretch(vectors: tuple[Vector, ...]) -> tuple[Vector, ...]:
        return tuple((fx * x, fy * y, fz * z) for x, y, z in vectors)

    return ModelShape(
        size_m=size,
        surfaces=tuple(
            Surface(
                height=fz * s.height,
                low=(fx * s.low[0], fy * s.low[1]),
                high=(fx * s.high[0], fy * s.high[1]),
                fill=s.fill,
            )
            for s in own.surfaces
        ),
        interiors=tuple(_stretch(interior, (fx, fy, fz)) for interior in own.interiors),
        parts=tuple(_map_part(part, stretch) for part in own.parts),
        leaves=tuple(_fit_leaf(leaf, (fx, fy, fz)) for leaf in own.leaves),
    )


def _stretch(interior: Interior, factors: Vector) -> Interior:
    low, high = (tuple(map(mul, factors, corner)) for corner in (interior.low, interior.high))
    return structs.replace(interior, low=low, high=high)


def _fit_leaf(leaf: LeafShape, factors: Vector) -> LeafShape:
    """Return a leaf of a stretched model. A hinge keeps its angles, a slide changes its travel."""
    fx, fy, fz = factors
    (x, y, z), (a, b, c) = leaf.anchor, leaf.axis
    u, v, w = (fx * a, fy * b, fz * c) if leaf.kind == "slide" else (a, b, c)
    length = math.sqrt(u * u + v * v + w * w)
    travel = length if leaf.kind == "slide" else 1.0
    return structs.replace(
        leaf,
        anchor=(fx * x, fy * y, fz * z),
        axis=(u / length, v / length, w / length),
        limits=None if leaf.limits is None else (travel * leaf.limits[0], travel * leaf.limits[1]),
        closed=None if leaf.closed is None else travel * leaf.closed,
        interiors=tuple(_stretch(interior, factors) for interior in leaf.interiors),
    )


def model_shape(model: str) -> ModelShape | None:
    """Return the shape of a model, or of a body of the world, at its own size; None without a model."""
    return shape_named(model) if model else None


def box(size: Size) -> ModelShape:
    """Return a box whose whole top is a supporting surface."""
    x, y, z = (extent / 2 for extent in size)
    return ModelShape(
        size_m=size,
        surfaces=(Surface(height=2 * z, low=(-x, -y), high=(x, y)),),
        parts=(ConvexPart(centre=(0.0, 0.0, z), straight=((x, 0.0, 0.0), (0.0, y, 0.0), (0.0, 0.0, z))),),
    )


def _map_part(part: ConvexPart, by: Callable[[tuple[Vector, ...]], tuple[Vector, ...]]) -> ConvexPart:
    """Return a part with its centre and vectors mapped, as for rotation and stretching."""
    (centre,) = by((part.centre,))
    return ConvexPart(centre=centre, straight=by(part.straight), round=by(part.round), points=by(part.points))


def need_quarter_turn(shape: ModelShape, sizes: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return (N,) whether the simulator turns the model to fit (N, 3) sizes (sim_node/models/library.py)."""
    own = shape.size_m
    longer, shorter = max(own[:2]), min(own[:2])
    may_turn = shape.turns and longer > 1.3 * shorter
    turned: NDArray[np.bool_] = (own[0] - own[1]) * (sizes[:, 0] - sizes[:, 1]) < 0.0
    return turned & may_turn


def turn_quarter(shape: ModelShape) -> ModelShape:
    """Return the shape rotated by -90 degrees about z: (x, y) becomes (y, -x)."""
    x, y, z = shape.size_m

    def turned(vectors: tuple[Vector, ...]) -> tuple[Vector, ...]:
        return tuple((y, -x, z) for x, y, z in vectors)

    return ModelShape(
        size_m=(y, x, z),
        surfaces=tuple(
            Surface(height=s.height, low=(s.low[1], -s.high[0]), high=(s.high[1], -s.low[0]), fill=s.fill)
            for s in shape.surfaces
        ),
        interiors=tuple(map(_turned, shape.interiors)),
        parts=tuple(_map_part(part, turned) for part in shape.parts),
        leaves=tuple(
            structs.replace(leaf, anchor=anchor, axis=axis, interiors=tuple(map(_turned, leaf.interiors)))
            for leaf in shape.leaves
            for anchor, axis in (turned((leaf.anchor, leaf.axis)),)
        ),
    )


def _turned(interior: Interior) -> Interior:
    (x0, y0, z0), (x1, y1, z1) = interior.low, interior.high
    return structs.replace(interior, low=(y0, -x1, z0), high=(y1, -x0, z1))
