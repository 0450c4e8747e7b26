"""Whether things stand out from the surface around them: by height, beyond the depth noise, or by colour.

A depth camera sees a flat carpet as hills of some millimetres, and its noise grows with the square of the
distance. The noise is measured in each frame: as far as the surface around a thing dips below its median, it
also rises without a thing. At depth edges a camera mixes near and far pixels to slivers along its rays.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from semmap.nodes.perception_node.input.cloud import Floats
from semmap.nodes.perception_node.segmentation.planes import thickness_m
from semmap.nodes.perception_node.segmentation.working_image import shades_of
from semmap.nodes.perception_node.views.merged_thing import Thing
from semmap.nodes.perception_node.views.segmented_view import SegmentedView

_EVERY = 4
"""Step of the pixels that are compared."""
_RING_CELLS = 20
_LEVEL = 2.5
"""The surface around a thing is within this multiple of a plane's tolerance."""
_FEWEST_AROUND, _SAMPLE = 20, 400
"""Minimum number of cells of the surface, and about the number of cells that are compared."""
_DIP, _TOP = 0.02, 0.9
"""Quantiles of the surface and of the thing: a dip is about two standard deviations deep."""
_LEAST_NOISE = 0.3
"""The noise is at least this share of a plane's tolerance."""
_SHADE_ERROR = 0.015
_DIPS, _DEVIATIONS, _LEAST = 3.0, 2.0, 1.5
"""A thing stands out if its height, in units of `_DIPS` dips, and its contrast, in units of `_DEVIATIONS`
standard deviations of the surface, add up to `_LEAST`."""
_UNKNOWN_CONTRAST = 1.0
_SMALL_POINTS = 300
"""A thing of fewer points needs twice the evidence: noise makes small patches more often than large ones."""
_FEWEST_POINTS, _FEWEST_CUT = 100, 600
"""Minimum number of points of a thing, and of one that an image edge cuts."""
_ALONG_RAY, _ELONGATED = np.cos(np.radians(12)), 2.5
_FEWEST_CELLS = 3
"""Fewer have no direction: a thing of a few millimetres, close to the camera."""


class Protrusion(NamedTuple):
    """How far a thing rises above the surface around it [m].

    `noise_m`: how far that surface dips. `contrast`: the difference in colour, in standard deviations, or
    `_UNKNOWN_CONTRAST`.
    """

    rise_m: float
    noise_m: float
    contrast: float

    @property
    def evidence(self) -> float:
        """Return the evidence for a thing, see `_LEAST`."""
        return self.rise_m / self.noise_m / _DIPS + self.contrast / _DEVIATIONS


def doubts(
    sights: Sequence[SegmentedView], labels: Sequence[NDArray[np.int32]], things: Sequence[Thing]
) -> list[str]:
    """Return for each thing the reason why it is probably noise, or an empty text.

    `labels`: for each view (H, W) the number of the thing, from 1. A thing must stand out in one view.
    Furniture and things of a detector are not doubted, nor those without a visible surface around them.
    """
    found: list[list[Protrusion | None]] = [[] for _ in things]
    for sight, label in zip(sights, labels, strict=True):
        if sight.cloud.organised:
            for number, one in _protrusions(sight, label[::_EVERY, ::_EVERY], things):
                found[number - 1].append(one)
    return [_doubt(thing, own) for thing, own in zip(things, found, strict=True)]


def _doubt(thing: Thing, found: Sequence[Protrusion | None]) -> str:
    if thing.carrier or thing.masked:
        return ""
    if thing.count < (_FEWEST_POINTS if thing.whole else _FEWEST_CUT):
        where = "" if thing.whole else " at the image edge"
        return f"only {thing.count} points{where}"
    if _is_along_ray(thing):
        return "a sliver along the line of sight, as between near and far pixels"
    seen = [one for one in found if one is not None]
    if not seen or len(seen) < len(found):
        return ""
    best = max(seen, key=lambda one: one.evidence)
    if best.evidence >= (_LEAST if thing.count >= _SMALL_POINTS else 2 * _LEAST):
        return ""
    return (
        f"rises {1000 * best.rise_m:.0f} mm above a surface with {1000 * best.noise_m:.0f} mm of noise, "
        "and has nearly its colour"
    )


def _is_along_ray(thing: Thing) -> bool:
    """Return whether a thing is elongated and points to the only camera that sees it."""
    if len(thing.eyes) > 1 or len(thing.cells) < _FEWEST_CELLS:
        return False
    middle = thing.cells.mean(axis=0)
    spread, axes = np.linalg.eigh(np.cov((thing.cells - middle).T))
    ray = middle - thing.eyes[0]
    along = abs(axes[:, 2] @ ray) / np.linalg.norm(ray)
    return bool(spread[2] > _ELONGATED**2 * spread[1] and along > _ALONG_RAY)


def _protrusions(
    sight: SegmentedView, labels: NDArray[np.int32], things: Sequence[Thing]
) -> list[tuple[int, Protrusion | None]]:
    """Return the number of each visible thing and its protrusion, None without a surface around it."""
    points = sight.cloud.points_camera[::_EVERY, ::_EVERY]
    colors = None if sight.cloud.colors is None else sight.cloud.colors[::_EVERY, ::_EVERY]
    up = sight.map_from_camera[2].astype(np.float32)
    depth, height = points[..., 2], points @ up[:3] + up[3]
    carrier = np.array([True, *(thing.carrier for thing in things)])
    seen = depth > 0  # NaN is not
    free = carrier[labels] & seen
    found: list[tuple[int, Protrusion | None]] = []
    for number, box in enumerate(ndimage.find_objects(labels), 1):
        if box is None or carrier[number]:
            continue
        window = tuple(slice(max(0, side.start - _RING_CELLS), side.stop + _RING_CELLS) for side in box)
        own = (labels[window] == number) & seen[window]
        if own.any():
            heights = height[window] - np.float32(things[number - 1].box.low[2])
            band = float(thickness_m(np.median(depth[window][own])))
            around = free[window] & (np.abs(heights) < _LEVEL * band)
            shown = None if colors is None else colors[window]
            found.append((number, _protrusion(heights, shown, _some(own), _some(around), band)))
    return found


def _some(where: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Return the flat indices of a sample of the cells (h, w) in `where`."""
    cells = np.flatnonzero(where)
    return cells[:: max(1, len(cells) // _SAMPLE)]


def _protrusion(
    heights: Floats,
    colors: NDArray[np.uint8] | None,
    own: NDArray[np.int64],
    around: NDArray[np.int64],
    band: float,
) -> Protrusion | None:
    """Return the protrusion of the cells `own` from those `around`, flat indices of `heights` (h, w)."""
    if len(around) < _FEWEST_AROUND:
        return None
    dip, base = _quantiles(heights.ravel()[around], (_DIP, 0.5)).tolist()
    rise = _quantiles(heights.ravel()[own], (_TOP,)).item() - base
    contrast = _UNKNOWN_CONTRAST
    if colors is not None:
        surface, thing = (shades_of(colors.reshape(-1, 3)[cells].T) for cells in (around, own))
        low, middle, high = _quantiles(surface, (0.16, 0.5, 0.84)).T
        apart = np.abs(_quantiles(thing, (0.5,))[:, 0] - middle)
        contrast = float((apart / ((high - low) / 2 + _SHADE_ERROR)).max())
    return Protrusion(rise, max(base - dip, _LEAST_NOISE * band), contrast)


def _quantiles(values: Floats, shares: Sequence[float]) -> Floats:
    """Return quantiles of values (..., N) without interpolation, which takes a tenth of the time."""
    last = values.shape[-1] - 1
    return np.asarray(np.sort(values, axis=-1)[..., [round(share * last) for share in shares]])
