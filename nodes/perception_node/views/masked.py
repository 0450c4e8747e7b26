"""Segments a cloud by the masks or boxes of a detector, instead of or in addition to our segments."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from semmap.nodes.perception_node.input.masks import DetectorLabel, Masks
from semmap.nodes.perception_node.views.boxed import FEWEST_POINTS, segments_in_boxes
from semmap.nodes.perception_node.views.segmented_view import SegmentedView, with_labels

_GAP_M, _GAP_SHARE = 0.015, 0.012
"""Maximum depth step on one surface: in metres, and as a share of the depth."""
_LEFT = 0.5
"""A segment or mask that is covered by more than this share counts as covered."""


def with_masks(sight: SegmentedView, masks: Masks) -> SegmentedView:
    """Return the view segmented by masks; elsewhere our segments remain, unless the masks are `alone`.

    A box without a mask stands for our segments that fill it. Raises ValueError for masks of another size.
    """
    if masks.labels.shape != sight.labels.shape:
        (h, w), (height, width) = masks.labels.shape, sight.labels.shape
        raise ValueError(f"the masks have {w} x {h} pixels, the image {width} x {height}")
    depth_m = sight.cloud.points_camera[..., 2]
    labels, count = np.zeros_like(sight.labels), 0
    found: dict[int, DetectorLabel] = {}
    unused = []
    carriers = set[int]()
    boxed = segments_in_boxes(sight.labels, masks) if masks.boxes else None
    given = masks.labels if boxed is None else boxed
    present = set(np.unique(given).tolist())
    for number, label in enumerate(masks.detector_labels, 1):
        if label is None and number not in present:
            continue  # a label image may skip numbers
        own = given == number
        if boxed is None:
            clear = own & (sight.planes == 0)
            if np.count_nonzero(clear) < _LEFT * np.count_nonzero(own):
                clear = own  # it lies flat on a plane, or is one
            own = _of_one_surface(clear, depth_m)
        if np.count_nonzero(own) < FEWEST_POINTS:
            unused.append(number)
            continue
        count += 1
        labels[own] = count
        if any(_is_most(own, sight.labels == carrier) for carrier in sight.carriers):
            carriers.add(count)
        if label is not None:
            found[count] = label
    masked = count
    if not masks.alone:
        for old in range(1, int(sight.labels.max(initial=0)) + 1):
            where = sight.labels == old
            free = where & (labels == 0)
            if np.count_nonzero(free) > max(FEWEST_POINTS, (1.0 - _LEFT) * np.count_nonzero(where)):
                count += 1
                labels[free] = count
                if old in sight.carriers:
                    carriers.add(count)
    undisputed = np.zeros((0, 0), np.float32)
    cut = with_labels(replace(sight, same=undisputed), labels, frozenset(carriers))
    named = tuple(
        replace(segment, masked=segment.label <= masked, detector_label=found.get(segment.label))
        for segment in cut.segments
    )
    return replace(cut, carriers=frozenset(carriers), segments=named, unused_masks=tuple(unused))


def _is_most(own: NDArray[np.bool_], carrier: NDArray[np.bool_]) -> bool:
    """Return whether pixels are most of a piece of furniture on which things may stand."""
    most = max(np.count_nonzero(own), np.count_nonzero(carrier))
    return bool(np.count_nonzero(own & carrier) > _LEFT * most)


def _of_one_surface(mask: NDArray[np.bool_], depth_m: NDArray[np.float32]) -> NDArray[np.bool_]:
    """Return the largest part of a mask without a depth step: its rim often lies on the background."""
    seen = mask & np.isfinite(depth_m)
    rows, columns = (np.flatnonzero(seen.any(axis=axis)) for axis in (1, 0))
    if not rows.size:
        return seen
    window = np.s_[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]
    part, depth = seen[window], np.where(seen[window], depth_m[window], 0.0)
    leap = np.zeros(part.shape, bool)
    for axis in (0, 1):
        near = np.minimum(*_neighbours(depth, axis))
        step = np.abs(np.diff(depth, axis=axis)) > _GAP_M + _GAP_SHARE * near
        both = _neighbours(part, axis)
        edge = step & both[0] & both[1]
        pad = [(0, 0), (0, 0)]
        pad[axis] = (0, 1)
        leap |= np.pad(edge, pad)
    pieces, many = ndimage.label(part & ~leap, np.ones((3, 3)))
    found = np.zeros_like(seen)
    if many:
        sizes = np.bincount(pieces.ravel())
        sizes[0] = 0
        found[window] = pieces == sizes.argmax()
    return found


def _neighbours(values: NDArray[np.generic], axis: int) -> tuple[NDArray[np.generic], NDArray[np.generic]]:
    return (values[:-1], values[1:]) if axis == 0 else (values[:, :-1], values[:, 1:])
