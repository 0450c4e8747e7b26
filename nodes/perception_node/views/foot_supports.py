"""Supports that are too small for a plane: a level ring of points around a thing's foot."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from semmap.nodes.perception_node.input.cloud import Floats
from semmap.nodes.perception_node.views.boxes import Numbers
from semmap.nodes.perception_node.views.furniture_planes import EVERY
from semmap.nodes.perception_node.views.merged_thing import Thing
from semmap.nodes.perception_node.views.segmented_view import SegmentedView
from semmap.nodes.perception_node.views.segments import in_map
from semmap.nodes.perception_node.views.supports import Support

_LIFTED_M = 0.1
"""Minimum distance above the support for a search."""
_WIDEST_M = 0.6
"""A ring around a wider thing consists of its neighbours."""
_AROUND_M = 0.08
_ABOVE_M, _BELOW_M = 0.02, 0.04
_LEVEL_M = 0.012
_FEWEST = 16
_SECTORS, _FEWEST_SECTORS = 8, 4


def supports_at_feet(sights: Sequence[SegmentedView], things: Sequence[Thing]) -> list[Support]:
    """Return the supports of small things that seem to float."""
    lifted = [thing for thing in things if _seems_to_float(thing)]
    if not lifted or not sights:
        return []
    views = [in_map(s.cloud.points_camera[::EVERY, ::EVERY], s.map_from_camera) for s in sights]
    points = np.concatenate([view.reshape(-1, 3) for view in views])
    found = (_support_at_foot(points, thing.cells) for thing in lifted)
    return [support for support in found if support is not None]


def _seems_to_float(thing: Thing) -> bool:
    return thing.lifted_m > _LIFTED_M and not thing.carrier and thing.box.size_m[:2].max() < _WIDEST_M


def _support_at_foot(points: Floats, cells: Numbers) -> Support | None:
    """Return the level ring of `points` (N, 3) around the foot of `cells` (M, 3), map frame [m]."""
    low, high = cells.min(axis=0), cells.max(axis=0)
    level = points[(points[:, 2] > low[2] - _BELOW_M) & (points[:, 2] < low[2] + _ABOVE_M)]
    beside = np.maximum(low[:2] - level[:, :2], level[:, :2] - high[:2]).max(axis=1)
    ring = level[(beside > 0.0) & (beside < _AROUND_M)]
    if len(ring) < _FEWEST:
        return None
    height = float(np.median(ring[:, 2]))
    ring = ring[np.abs(ring[:, 2] - height) < _LEVEL_M]
    x, y = (ring[:, :2] - (low + high)[:2] / 2).T
    sectors = np.unique(np.floor((np.arctan2(y, x) / (2.0 * np.pi) + 0.5) * _SECTORS).astype(int) % _SECTORS)
    if len(ring) < _FEWEST or len(sectors) < _FEWEST_SECTORS:
        return None
    (left, back), (right, front) = ring[:, :2].min(axis=0).tolist(), ring[:, :2].max(axis=0).tolist()
    return Support(height, (left, back), (right, front), (right - left) * (front - back))
