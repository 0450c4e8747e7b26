"""Fronts: a thing between others is first seen from the front, without its depth."""

from __future__ import annotations

import math

from semmap.nodes.perception_node.tracking.overlap import OrientedBox, share

_FLAT = 0.75
"""A front is less deep than this share of its width."""
_DEEPER = 1.4
_DEEPEST = 1.25
"""Maximum ratio of depth to width of a thing with a front."""
_ALIKE = 0.25
_WITHIN = 0.65
_LEAST_M = 0.3
"""The sides of a narrower thing are visible, and the top of one that is lower than wide."""


def is_front(piece: OrientedBox, thing: OrientedBox) -> bool:
    """Return whether a box is the front of a thing, and the other box the complete thing, which is deeper.

    A partly seen table top is not a front, nor is one merged with a chair the complete table.
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
