"""Detects free-standing things, which are not pieces of others."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.recognition.joining import near_pairs
from semmap.nodes.perception_node.views.boxes import Box, in_frame
from semmap.nodes.perception_node.views.merged_thing import Thing

_SMALLEST_M, _LARGEST_M = 0.025, 0.5
"""Limits of its largest extent: less is a piece, more is furniture or a wall."""
_THINNEST_M = 0.005
"""Minimum height: less is depth noise, or a patch of another colour."""
_SLENDER, _LEG_M = 5.0, 0.25
"""A thing this high, and this many times higher than wide, may be a leg of a hidden table."""

_EDGE_M = 0.1
"""A table has its legs within this distance of its edges; a thing below may be a piece of one."""

_LIFTED_M = 0.06
"""Maximum height of the lowest visible point above the support; another thing may hide the foot."""
_BESIDE_M = 0.015
"""A thing with this much clearance is not a piece of its neighbour."""
_FEWEST, _FEWEST_BESIDE = 100, 500
"""Minimum number of points of a thing apart from others, and of one beside others."""
_WORTH = 0.1
"""A neighbour with a smaller share of its points is itself a piece."""
_PIECE = 4.0
"""A thing may be a piece of a recognised neighbour with so many times its points."""


def are_free_standing(things: Sequence[Thing], recognised: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return (N,) whether each thing is compact, whole, on a support, and not a piece of a neighbour.

    It may be a piece of furniture, of other fragments, and of a much larger thing that is `recognised` (N,),
    which is not classified as clutter. A thing below an edge of a table is excluded.
    """
    tables = [thing.box for thing in things if thing.carrier]
    alone = np.array(
        [is_compact(one) and not any(_is_below_edge(one, box) for box in tables) for one in things],
        dtype=bool,
    )
    for a, b in near_pairs(things, _BESIDE_M):
        for one, other in ((a, b), (b, a)):
            small = not things[other].carrier and things[other].box.size_m.max() <= _LARGEST_M
            clear = small and recognised[other] and things[one].count >= _FEWEST_BESIDE
            share = _PIECE if clear else _WORTH
            if things[other].count > share * things[one].count:
                alone[one] = False
    return alone


def _is_below_edge(thing: Thing, table: Box) -> bool:
    """Return whether a thing is below a table, near one of its edges."""
    cells = in_frame(thing.cells, table.yaw_rad)
    middle = cells.mean(axis=0)[:2]
    to_sides = np.minimum(middle - table.low[:2], table.high[:2] - middle)
    return bool(0.0 < to_sides.min() < _EDGE_M and cells[:, 2].max() < table.high[2] - _EDGE_M)


def is_compact(thing: Thing) -> bool:
    """Return whether a thing has the size of tabletop things, is fully visible and on a support."""
    x, y, z = thing.box.size_m.tolist()
    return (
        not thing.carrier
        and thing.whole
        and thing.count >= _FEWEST
        and reaches_support(thing)
        and _SMALLEST_M <= max(x, y, z) <= _LARGEST_M
        and _THINNEST_M <= z < max(_LEG_M, _SLENDER * max(x, y))
    )


def reaches_support(thing: Thing) -> bool:
    """Return whether a thing is visible down to its support, or almost."""
    return thing.lifted_m < _LIFTED_M
