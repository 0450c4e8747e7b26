"""Parallelograms, ellipses and bounds on the floor plan, many at once: (N, 2) vectors, (N, 4) bounds [m].

A parallelogram is given by its centre and half of each side, `u` and `v`, an ellipse by its semi-axes.
"""

from __future__ import annotations

import numpy as np

from semmap.nodes.kb_node.relations.geometry.form_columns import Bools, Floats

GUARD = 1e-6
"""Lengths [m], shares and multiples of `u` and `v` this close to a limit are not clear."""
_LEAST_AREA = 1e-8
_INSIDE_OCTAGON = 0.94
"""In squared semi-axes: the part of an ellipse that is within its octagon for certain."""


def cross(a: Floats, b: Floats) -> Floats:
    """Return (N,) signed areas spanned by vectors."""
    found: Floats = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    return found


def compute_areas(u: Floats, v: Floats) -> Floats:
    """Return (N,) areas of parallelograms."""
    found: Floats = 4.0 * np.abs(cross(u, v))
    return found


def decompose(vectors: Floats, u: Floats, v: Floats) -> tuple[Floats, Floats]:
    """Return vectors as multiples of `u` and `v`, or NaN if these are parallel."""
    whole = cross(u, v)
    whole = np.where(np.abs(whole) > _LEAST_AREA, whole, np.nan)
    return cross(vectors, v) / whole, cross(u, vectors) / whole


def compute_extents(middle: Floats, a: Floats, b: Floats, u: Floats, v: Floats) -> tuple[Floats, Floats]:
    """Return how far a parallelogram of half sides `a` and `b` extends from the origin, in `u` and `v`."""
    (s, t), (a_s, a_t), (b_s, b_t) = (decompose(vectors, u, v) for vectors in (middle, a, b))
    return np.abs(s) + np.abs(a_s) + np.abs(b_s), np.abs(t) + np.abs(a_t) + np.abs(b_t)


def are_within(s: Floats, t: Floats) -> Bools:
    """Return whether these extents are clearly within a parallelogram. NaN is not."""
    found: Bools = np.maximum(np.abs(s), np.abs(t)) < 1.0 - GUARD
    return found


def are_within_outline(s: Floats, t: Floats, is_disc: Floats) -> Bools:
    """Return whether these extents are clearly within an ellipse or a parallelogram."""
    found: Bools = np.where(is_disc > 0.0, s * s + t * t < _INSIDE_OCTAGON, are_within(s, t))
    return found


def bounds_around(middle: Floats, u: Floats, v: Floats) -> Floats:
    """Return the bounds of parallelograms."""
    half = np.abs(u) + np.abs(v)
    return np.concatenate([middle - half, middle + half], axis=1)


def compute_intersections(one: Floats, other: Floats) -> Floats:
    """Return the areas of the intersections of bounds."""
    both = np.minimum(one[:, 2:], other[:, 2:]) - np.maximum(one[:, :2], other[:, :2])
    found: Floats = np.maximum(both, 0.0).prod(axis=1)
    return found


def compute_uncertainty(position: Floats, areas: Floats) -> Floats:
    """Return the margin within which shares of areas are not clear. It grows far from the origin."""
    found: Floats = GUARD + 1e-14 * np.abs(position[:, :2]).sum(axis=1) ** 2 / areas
    return found
