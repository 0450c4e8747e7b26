"""Supports that are other things: a thing that seems to float stands on one below it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from semmap.nodes.perception_node.views.boxes import Numbers
from semmap.nodes.perception_node.views.merged_thing import Thing
from semmap.nodes.perception_node.views.supports import Support

_LIFTED_M = 0.1
"""Minimum distance above the support for a search."""
_ABOVE_M, _BELOW_M = 0.03, 0.05
_FEWEST = 12
_BENEATH = 0.5
"""Minimum share of a thing's outline over the top, both as rectangles."""
_LOWER = 0.9
"""Minimum share of the supporting thing below the foot, since other things may also be beside it."""


def supports_of_things(things: Sequence[Thing]) -> list[Support]:
    """Return the tops of things on which apparently floating things stand."""
    lifted = [thing for thing in things if thing.lifted_m > _LIFTED_M and not thing.carrier]
    tops = (_top(other, thing.cells) for thing in lifted for other in things if other is not thing)
    return [top for top in tops if top is not None]


def _top(thing: Thing, cells: Numbers) -> Support | None:
    """Return a thing's top as a support, if it is at the foot of `cells` (N, 3), map frame [m]."""
    low, high = cells.min(axis=0), cells.max(axis=0)
    lower = thing.cells[:, 2] < low[2] + _ABOVE_M
    level = thing.cells[lower & (thing.cells[:, 2] > low[2] - _BELOW_M)]
    if len(level) < _FEWEST or lower.mean() < _LOWER:
        return None
    begins, ends = level[:, :2].min(axis=0), level[:, :2].max(axis=0)
    shared = np.minimum(high[:2], ends) - np.maximum(low[:2], begins)
    if np.prod(np.clip(shared / np.maximum((high - low)[:2], 1e-3), 0.0, 1.0)) < _BENEATH:
        return None
    (left, back), (right, front) = begins.tolist(), ends.tolist()
    return Support(
        float(np.median(level[:, 2])), (left, back), (right, front), (right - left) * (front - back)
    )
