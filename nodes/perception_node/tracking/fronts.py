"""Fronts: of what stands between others a camera before it sees the front, and how deep it is only later."""

from __future__ import annotations

import math

from semmap.nodes.perception_node.tracking.overlap import OrientedBox, share

_FLAT = 0.75
"""A front is less deep than this share of its width."""
_DEEPER = 1.4
_DEEPEST = 1.25
"""How many times as deep as wide what has a front may be."""
_ALIKE = 0.25
_WITHIN = 0.65
_LEAST_M = 0.3
"""Of what is narrower a camera sees the sides, too, and of what is lower than wide the top."""


def is_front(piece: OrientedBox, thing: OrientedBox) -> bool:
    """Whether a box holds the front of a thing and the other box all of it, as wide and high, but deeper.

    A table top that is seen in part is none, nor is it with a chair in it all of the table.
    """
    depth, width = sorted(piece.size_m[:2])
    deep, wide = sorted(thing.size_m[:2])
    height = piece.size_m[2]
    if depth > _FLAT * width or height < width or width < _LEAST_M:
        return False
    if not _unlike(width, wide) < _ALIKE:
        deep, wide = wide, deep
    return (
        _unlike(width, wide) < _ALIKE
        and _unlike(piece.size_m[2], thing.size_m[2]) < _ALIKE
        and _DEEPER * depth < deep < _DEEPEST * wide
        and share(piece, thing) > _WITHIN
    )


def _unlike(one: float, other: float) -> float:
    return abs(math.log(one / other))
