"""Layout of a graph. Nodes that were drawn before stay near their positions."""

from __future__ import annotations

import math
import zlib
from collections.abc import Mapping
from typing import Final

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.drawing.neighbourhood import Neighbourhood

Floats = NDArray[np.float64]
Positions = dict[str, tuple[float, float]]

_STEPS: Final = 220
_STEPS_AGAIN: Final = 120
_SPRING: Final = 0.06
_LENGTH: Final = 95.0
"""Rest length of a link [pixel]."""
_PUSH: Final = 5200.0
_FLAT: Final = 0.55
"""Weight of horizontal distances: labels are wider than high."""
_LETTER, _LINE, _GAP = 7.5, 34.0, 14.0


def arrange(graph: Neighbourhood, before: Mapping[str, tuple[float, float]]) -> Positions:
    """Return a position [pixel] for each node, y down. The result is deterministic.

    Nodes with a position in `before` move only as far as new nodes push them.
    """
    ids = [knot.id for knot in graph.knots]
    if not ids:
        return {}
    index = {name: i for i, name in enumerate(ids)}
    links = [(index[a], index[b]) for a, b, _ in graph.links if a in index and b in index and a != b]
    known = np.array([name in before for name in ids])
    centres = [i for i, knot in enumerate(graph.knots) if knot.kind == "centre"]
    points = _start(graph, before, links, centres)
    ends = np.array(links, dtype=np.intp).reshape(-1, 2)
    stiffness = np.where(known, 0.25, 1.0)[:, None]
    steps = _STEPS_AGAIN if known.any() else _STEPS
    for step in range(steps):
        heat = 18.0 * (1.0 - step / steps)
        shift = _forces(points, ends) - 0.012 * points
        length = np.maximum(np.linalg.norm(shift, axis=1, keepdims=True), 1e-9)
        points += shift / length * np.minimum(length, heat) * stiffness
    half_width = np.array([_LETTER * min(len(knot.label), 28) / 2.0 + _GAP / 2.0 for knot in graph.knots])
    _separate_labels(points, half_width)
    return {name: (round(x, 1), round(y, 1)) for name, (x, y) in zip(ids, points.tolist(), strict=True)}


def _start(
    graph: Neighbourhood,
    before: Mapping[str, tuple[float, float]],
    links: list[tuple[int, int]],
    centres: list[int],
) -> Floats:
    """Return start positions: the earlier one, or one near a neighbour, at an angle derived from the id."""
    near: dict[int, int] = {}
    for a, b in links:
        near.setdefault(a, b)
        near.setdefault(b, a)
    points = np.zeros((len(graph.knots), 2))
    placed = {i for i, knot in enumerate(graph.knots) if knot.id in before}
    for i in placed:
        points[i] = before[graph.knots[i].id]
    fresh = [i for i in range(len(graph.knots)) if i not in placed]
    for i in sorted(fresh, key=lambda i: i not in centres):
        angle = 2.0 * math.pi * (zlib.crc32(graph.knots[i].id.encode()) / (1 << 32))
        anchor = near.get(i)
        near_to = points[anchor] if anchor in placed or anchor in centres else np.zeros(2)
        reach = _LENGTH if i not in centres else 0.5 * _LENGTH * (len(centres) > 1)
        points[i] = near_to + reach * np.array([math.cos(angle), _FLAT * math.sin(angle)])
    return points


def _forces(points: Floats, ends: NDArray[np.intp]) -> Floats:
    """Return the forces: all nodes repel each other, and links attract."""
    scale = np.array([_FLAT, 1.0])
    apart = (points[:, None, :] - points[None, :, :]) * scale
    squared = (apart * apart).sum(axis=2) + 1.0
    push = (_PUSH / squared)[:, :, None] * apart / np.sqrt(squared)[:, :, None]
    force: Floats = push.sum(axis=1)
    if len(ends):
        along = points[ends[:, 1]] - points[ends[:, 0]]
        length = np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-9)
        pull = _SPRING * (length - _LENGTH) * along / length
        np.add.at(force, ends[:, 0], pull)
        np.subtract.at(force, ends[:, 1], pull)
    return force


def _separate_labels(points: Floats, half_width: Floats) -> None:
    """Move overlapping labels apart, along the axis with the smaller overlap."""
    for _ in range(60):
        apart = points[:, None, :] - points[None, :, :]
        lack_x = half_width[:, None] + half_width[None, :] - np.abs(apart[:, :, 0])
        lack_y = _LINE - np.abs(apart[:, :, 1])
        pairs = np.argwhere(np.triu((lack_x > 0.0) & (lack_y > 0.0), 1))
        if not len(pairs):
            return
        for i, j in pairs.tolist():
            across = 0 if lack_x[i, j] < lack_y[i, j] else 1
            lack = (lack_x, lack_y)[across][i, j] + 0.5
            sign = 1.0 if apart[i, j, across] >= 0.0 else -1.0
            points[i, across] += sign * lack / 2.0
            points[j, across] -= sign * lack / 2.0
