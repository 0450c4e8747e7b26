"""Supports that are other things: what seems to hang in the air stands on the top of one below it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from semmap.nodes.perception_node.views.boxes import Numbers
from semmap.nodes.perception_node.views.merged_thing import Thing
from semmap.nodes.perception_node.views.supports import Support

_LIFTED_M = 0.1
"""Only what would stand this far above its support is asked about."""
_ABOVE_M, _BELOW_M = 0.03, 0.05
_FEWEST = 12
_BENEATH = 0.5
"""A top is below this share of a thing's outline, both taken as rectangles."""
_LOWER = 0.9
"""Of what goes on above a thing's foot at its side, less is lower than the foot."""


def supports_of_things(things: Sequence[Thing]) -> list[Support]:
    """The tops of things on which others stand that seem to hang in the air."""
    lifted = [thing for thing in things if thing.lifted_m > _LIFTED_M and not thing.carrier]
    tops = (_top(other, thing.cells) for thing in lifted for other in things if other is not thing)
    return [top for top in tops if top is not None]


def _top(thing: Thing, cells: Numbers) -> Support | None:
    """A thing's top as a support, if that is at the foot of what has some `cells` (N, 3), map frame [m]."""
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
