"""Which things stand by themselves: whatever else they are, no scraps of others."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.recognition.joining import near_pairs
from semmap.nodes.perception_node.views.boxes import Box, in_frame
from semmap.nodes.perception_node.views.merged_thing import Thing

_SMALLEST_M, _LARGEST_M = 0.025, 0.5
"""What such a thing measures at most: less is a scrap, more a piece of furniture or a wall."""
_SLENDER, _LEG_M = 5.0, 0.25
"""What is so high, and so many times as high as wide, may be the leg of a table whose top is not seen."""

_EDGE_M = 0.1
"""So near to its edges a table has its legs: what is below them there may be a piece of one."""

_LIFTED_M = 0.03
_BESIDE_M = 0.015
"""What has so much room about it is no scrap of its neighbour."""
_FEWEST = 100
_WORTH = 0.1
"""A neighbour with a smaller share of its points is a scrap of its own."""


def are_free_standing(things: Sequence[Thing]) -> NDArray[np.bool_]:
    """(N,) whether each is compact, seen whole, upon its support, beside nothing else and below no edge."""
    tables = [thing.box for thing in things if thing.carrier]
    alone = np.array(
        [is_compact(one) and not any(_is_below_edge(one, box) for box in tables) for one in things],
        dtype=bool,
    )
    for a, b in near_pairs(things, _BESIDE_M):
        for one, other in ((a, b), (b, a)):
            if things[other].count > _WORTH * things[one].count:
                alone[one] = False
    return alone


def _is_below_edge(thing: Thing, table: Box) -> bool:
    """Whether it is within a table's box near one of its sides, and well below its top."""
    cells = in_frame(thing.cells, table.yaw_rad)
    middle = cells.mean(axis=0)[:2]
    to_sides = np.minimum(middle - table.low[:2], table.high[:2] - middle)
    return bool(0.0 < to_sides.min() < _EDGE_M and cells[:, 2].max() < table.high[2] - _EDGE_M)


def is_compact(thing: Thing) -> bool:
    """Of the size of what stands on tables, seen whole, and upon its support."""
    x, y, z = thing.box.size_m.tolist()
    return (
        not thing.carrier
        and thing.whole
        and thing.count >= _FEWEST
        and thing.lifted_m < _LIFTED_M
        and _SMALLEST_M <= max(x, y, z) <= _LARGEST_M
        and z < max(_LEG_M, _SLENDER * max(x, y))
    )
