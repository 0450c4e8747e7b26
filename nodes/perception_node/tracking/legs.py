"""Legs of furniture, which a camera may see separately from the seat or top above them."""

from __future__ import annotations

import math

from semmap.nodes.perception_node.tracking.overlap import OrientedBox

_FLOOR_M = 0.06
_SLENDER_M = 0.1
_UPRIGHT = 1.2
_TALL_M, _WIDE_M = 0.35, 0.3
_AT_CORNER_M = 0.08


def is_leg(piece: OrientedBox, thing: OrientedBox) -> bool:
    """Return whether a piece is a leg of a thing: slender, upright, on the floor, and below a corner.

    A bottle under the middle of a table, or next to one, is not a leg.
    """
    (x, y, low), (width, depth, height) = piece.pose.position_m, piece.size_m
    (centre_x, centre_y, floor), (wide, deep, tall) = thing.pose.position_m, thing.size_m
    broad = max(width, depth)
    if max(low, floor) > _FLOOR_M or broad > _SLENDER_M or height < _UPRIGHT * broad:
        return False
    if tall < max(_TALL_M, height) or min(wide, deep) < _WIDE_M:
        return False
    c, s = math.cos(thing.pose.yaw_rad), math.sin(thing.pose.yaw_rad)
    along, across = c * (x - centre_x) + s * (y - centre_y), c * (y - centre_y) - s * (x - centre_x)
    return math.hypot(abs(along) - wide / 2.0, abs(across) - deep / 2.0) < _AT_CORNER_M
