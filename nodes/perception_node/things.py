"""What all views together show of one thing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from nodes.perception_node.boxes import Box, Numbers, best_yaw, box_around
from nodes.perception_node.cloud import Floats
from nodes.perception_node.segments import Segment

_CELLS_ALONG = 40
_CELL_M = (0.004, 0.02)
_CROWDED = 4.0
_GAP_CELLS, _MOST_GAPS = 3, 100
_STRAY = 0.06
_AROUND = np.ones((3, 3, 3))
_BELOW_M = 0.03
_BODY_M = 0.15


@dataclass(frozen=True)
class Thing:
    """One thing as it was seen, not yet completed by what is hidden.

    `cells`: (N, 3) one point for each small cube that holds any, map frame [m], so that near and far, seen
    once and seen twice weigh the same; `colors`: (N, 3) their mean colours in [0, 1], or None.
    `box`: around the cells, down to the support. `eyes`: (V, 3) where the cameras were [m].
    `lifted_m`: how far above the support the lowest point is.
    """

    segments: tuple[Segment, ...]
    cells: Numbers
    colors: Numbers | None
    box: Box
    eyes: NDArray[np.float64]
    lifted_m: float

    @property
    def carrier(self) -> bool:
        """Others may stand on it: a top of it was seen."""
        return any(segment.carrier for segment in self.segments)

    @property
    def whole(self) -> bool:
        """No picture's edge cuts it."""
        return not any(segment.cut for segment in self.segments)

    @property
    def count(self) -> int:
        """Points of all views."""
        return sum(segment.count for segment in self.segments)


def thing_of(segments: Sequence[Segment], supports_m: Sequence[float]) -> Thing:
    """Put the segments of one thing together; it stands on the highest support that is not above it.

    Of a table often the top alone is seen, which is no support of its own.
    """
    points = np.concatenate([segment.points for segment in segments])
    shades = [segment.colors for segment in segments if segment.colors is not None]
    colors = np.concatenate(shades) if len(shades) == len(segments) else None
    cells, shade = _cells(points, colors)
    lowest, highest = float(cells[:, 2].min()), float(cells[:, 2].max())
    carrier = any(segment.carrier for segment in segments)
    below = min(lowest, highest - _BODY_M) if carrier else lowest
    floor = min(0.0, lowest) if carrier else lowest
    support = max((height for height in supports_m if height < below + _BELOW_M), default=floor)
    return Thing(
        segments=tuple(segments),
        cells=cells,
        colors=shade,
        box=box_around(cells, best_yaw(cells), support),
        eyes=np.unique([segment.eye for segment in segments], axis=0),
        lifted_m=lowest - support,
    )


def _cells(points: Floats, colors: NDArray[np.uint8] | None) -> tuple[Numbers, Numbers | None]:
    """The mean point and colour of each occupied cube; lonely points go where others crowd."""
    points, colors = _without_strays(points, colors)
    low = points.min(axis=0)
    edge = _edge_m(points)
    key = ((points - low) / edge).astype(np.int64) @ np.array([1 << 40, 1 << 20, 1])
    _, cell, counts = np.unique(key, return_inverse=True, return_counts=True)
    keep = counts > (1 if counts.mean() > _CROWDED else 0)
    means = [np.bincount(cell, points[:, axis])[keep] / counts[keep] for axis in range(3)]
    if colors is None:
        return np.stack(means, axis=1), None
    shade = [np.bincount(cell, colors[:, channel])[keep] / (255.0 * counts[keep]) for channel in range(3)]
    return np.stack(means, axis=1), np.stack(shade, axis=1)


def _without_strays(
    points: Floats, colors: NDArray[np.uint8] | None
) -> tuple[Floats, NDArray[np.uint8] | None]:
    """Without the few points far from all others: a thing's outline holds some of what is behind it."""
    edge = max(_GAP_CELLS * _edge_m(points), float(np.ptp(points, axis=0).max()) / _MOST_GAPS)
    place = ((points - points.min(axis=0)) / edge).astype(np.int64)
    full = np.zeros(place.max(axis=0) + 1, bool)
    full[tuple(place.T)] = True
    cluster = ndimage.label(full, _AROUND)[0][tuple(place.T)]
    sizes = np.bincount(cluster)
    keep = sizes[cluster] >= min(_STRAY * len(points), sizes.max())
    return points[keep], None if colors is None else colors[keep]


def _edge_m(points: Floats) -> float:
    return float(np.clip(np.ptp(points, axis=0).max() / _CELLS_ALONG, *_CELL_M))
