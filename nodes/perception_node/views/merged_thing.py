"""One thing, merged from all views."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from semmap.nodes.perception_node.input.cloud import Floats
from semmap.nodes.perception_node.views.boxes import Box, Numbers, best_yaw, box_around
from semmap.nodes.perception_node.views.segments import Segment
from semmap.nodes.perception_node.views.supports import Support, height_below

_CELLS_ALONG, _MOST_CELLS = 40, 150
_CELL_M = (0.004, 0.02)
_CROWDED = 4.0
_GAP_CELLS = 3
_STRAY = 0.06
_AROUND = np.ones((3, 3, 3))
_BELOW_M = 0.03
_BODY_M = 0.15


@dataclass(frozen=True)
class Thing:
    """The visible part of one thing.

    `cells`: (N, 3) one point per occupied voxel, map frame [m], so that near, far and repeated points have
    equal weight. `colors`: (N, 3) mean colours in [0, 1], or None. `box`: around the cells, down to the
    support. `eyes`: (V, 3) camera positions [m]. `lifted_m`: height of the lowest point above the support.
    """

    segments: tuple[Segment, ...]
    cells: Numbers
    colors: Numbers | None
    box: Box
    eyes: NDArray[np.float64]
    lifted_m: float

    @property
    def carrier(self) -> bool:
        """Return whether others may stand on it, because a top was seen."""
        return any(segment.carrier for segment in self.segments)

    @property
    def masked(self) -> bool:
        """Return whether it is from an external detector."""
        return any(segment.masked for segment in self.segments)

    @property
    def whole(self) -> bool:
        """Return whether no image edge cuts it."""
        return not any(segment.cut for segment in self.segments)

    @property
    def count(self) -> int:
        """Return the number of points in all views."""
        return sum(segment.count for segment in self.segments)


def thing_of(segments: Sequence[Segment], supports: Sequence[Support]) -> Thing:
    """Merge the segments of one thing; it stands on the highest support below it.

    If only a table's top is visible, it is not its own support.
    """
    points = np.concatenate([segment.points for segment in segments])
    shades = [segment.colors for segment in segments if segment.colors is not None]
    colors = np.concatenate(shades) if len(shades) == len(segments) else None
    cells, shade = _cells(points, colors)
    low, high = cells.min(axis=0), cells.max(axis=0)
    lowest, highest = float(low[2]), float(high[2])
    carrier = any(segment.carrier for segment in segments)
    below = min(lowest, highest - _BODY_M) if carrier else lowest
    floor = min(0.0, lowest) if carrier else lowest
    support = height_below(supports, low, high, most_m=below + _BELOW_M, floor_m=floor)
    return Thing(
        segments=tuple(segments),
        cells=cells,
        colors=shade,
        box=box_around(cells, best_yaw(cells), support),
        eyes=np.array(sorted({tuple(segment.eye.tolist()) for segment in segments})),
        lifted_m=lowest - support,
    )


def _cells(points: Floats, colors: NDArray[np.uint8] | None) -> tuple[Numbers, Numbers | None]:
    """Return mean point and colour of each occupied voxel; isolated points in dense clouds are removed."""
    cell, counts, far = _cubes(points)
    if far.any():
        keep = ~far[cell]
        points, colors = points[keep], None if colors is None else colors[keep]
        cell, counts, _ = _cubes(points)
    crowded = counts > (1 if counts.mean() > _CROWDED else 0)

    def means(values: NDArray[np.generic]) -> Numbers:
        sums = np.array([np.bincount(cell, column)[crowded] for column in values.T])
        return np.asarray((sums / counts[crowded]).T)

    return means(points), None if colors is None else means(colors) / 255.0


def _cubes(points: Floats) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.bool_]]:
    """Return (N,) the voxel of each point, (C,) the counts, and which voxels are far from all others.

    The outline of a thing includes some background points, which are far from it.
    """
    corners = np.ascontiguousarray(points.T)  # a minimum over long rows is faster
    low, high = corners.min(axis=1), corners.max(axis=1)
    longest = (high - low).max()
    edge = max(np.clip(longest / _CELLS_ALONG, *_CELL_M), longest / _MOST_CELLS)
    place = ((corners - low[:, None]) / edge).astype(np.int64)
    shape = place.max(axis=1) + 1
    key = (place[0] * shape[1] + place[1]) * shape[2] + place[2]
    any_point = np.full(int(shape.prod()), -1, np.int32)  # in each cube
    any_point[key] = np.arange(len(key))
    used = np.flatnonzero(any_point >= 0)
    coarse = tuple(place.take(any_point[used], axis=1) // _GAP_CELLS)
    any_point[used] = np.arange(len(used))  # from here on the cube's number
    cell = any_point[key]
    counts = np.bincount(cell)
    full = np.zeros(shape // _GAP_CELLS + 1, bool)
    full[coarse] = True
    cluster = ndimage.label(full, _AROUND)[0][coarse]
    sizes = np.bincount(cluster, counts)
    return cell, counts, sizes[cluster] < min(_STRAY * len(points), sizes.max())
