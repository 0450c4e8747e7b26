"""Parallelograms, ellipses and bounds on the floor plan, many at once: (N, 2) vectors, (N, 4) bounds [m].

A parallelogram is told by its middle and half of each of its sides, `u` and `v`; an ellipse by its semi-axes.
"""

from __future__ import annotations

import numpy as np

from semmap.nodes.kb_node.relations.geometry.form_columns import Bools, Floats

GUARD = 1e-6
"""Lengths [m], shares and multiples of `u` and `v` that are this near to a limit are not plain."""
_LEAST_AREA = 1e-8
_INSIDE_OCTAGON = 0.94
"""Of an ellipse, in squares of its semi-axes: so far the octagon that stands for it reaches for certain."""


def cross(a: Floats, b: Floats) -> Floats:
    """(N,) areas that vectors span."""
    found: Floats = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    return found


def spanned(u: Floats, v: Floats) -> Floats:
    """(N,) areas of parallelograms."""
    found: Floats = 4.0 * np.abs(cross(u, v))
    return found


def along(vectors: Floats, u: Floats, v: Floats) -> tuple[Floats, Floats]:
    """Vectors as multiples of `u` and `v`; NaN where these span nothing."""
    whole = cross(u, v)
    whole = np.where(np.abs(whole) > _LEAST_AREA, whole, np.nan)
    return cross(vectors, v) / whole, cross(u, vectors) / whole


def reach(middle: Floats, a: Floats, b: Floats, u: Floats, v: Floats) -> tuple[Floats, Floats]:
    """How far a parallelogram of half sides `a` and `b` reaches from the origin, as `along` has it."""
    (s, t), (a_s, a_t), (b_s, b_t) = (along(vectors, u, v) for vectors in (middle, a, b))
    return np.abs(s) + np.abs(a_s) + np.abs(b_s), np.abs(t) + np.abs(a_t) + np.abs(b_t)


def are_within(s: Floats, t: Floats) -> Bools:
    """Whether what reaches so far is plainly within a parallelogram; NaN is not."""
    found: Bools = np.maximum(np.abs(s), np.abs(t)) < 1.0 - GUARD
    return found


def are_on_top(s: Floats, t: Floats, is_disc: Floats) -> Bools:
    """Whether what reaches so far is plainly on a top that is an ellipse or a parallelogram."""
    found: Bools = np.where(is_disc > 0.0, s * s + t * t < _INSIDE_OCTAGON, are_within(s, t))
    return found


def bounds_around(middle: Floats, u: Floats, v: Floats) -> Floats:
    """The bounds of parallelograms."""
    half = np.abs(u) + np.abs(v)
    return np.concatenate([middle - half, middle + half], axis=1)


def common(one: Floats, other: Floats) -> Floats:
    """The areas that bounds have in common."""
    both = np.minimum(one[:, 2:], other[:, 2:]) - np.maximum(one[:, :2], other[:, :2])
    found: Floats = np.maximum(both, 0.0).prod(axis=1)
    return found


def doubt(position: Floats, areas: Floats) -> Floats:
    """How near shares of areas may be to a limit and not be plain: far from the origin these are rough."""
    found: Floats = GUARD + 1e-14 * np.abs(position[:, :2]).sum(axis=1) ** 2 / areas
    return found
