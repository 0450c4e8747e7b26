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
_FEWEST_AROUND = 20
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
    if len(thing.eyes) > 1:
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
    carrier = np.array([True, *(thing.carrier for thing in things)])
    free = carrier[labels] & (points[..., 2] > 0)  # NaN is not
    found: list[tuple[int, Protrusion | None]] = []
    for number, box in enumerate(ndimage.find_objects(labels), 1):
        if box is None or carrier[number]:
            continue
        window = tuple(slice(max(0, side.start - _RING_CELLS), side.stop + _RING_CELLS) for side in box)
        own = (labels[window] == number) & (points[window][..., 2] > 0)
        if own.any():
            heights = points[window] @ up[:3] + (up[3] - np.float32(things[number - 1].box.low[2]))
            near = points[window][..., 2][own]
            band = float(thickness_m(np.median(near)))
            around = free[window] & (np.abs(heights) < _LEVEL * band)
            shades = None if colors is None else shades_of(np.moveaxis(colors[window], -1, 0))
            found.append((number, _protrusion(heights, shades, own, around, band)))
    return found


def _protrusion(
    heights: Floats,
    shades: Floats | None,
    own: NDArray[np.bool_],
    around: NDArray[np.bool_],
    band: float,
) -> Protrusion | None:
    if np.count_nonzero(around) < _FEWEST_AROUND:
        return None
    level = heights[around]
    base, dip = np.quantile(level, [0.5, _DIP]).tolist()
    rise = float(np.quantile(heights[own], _TOP)) - base
    contrast = _UNKNOWN_CONTRAST
    if shades is not None:
        low, middle, high = np.quantile(shades[:, around], [0.16, 0.5, 0.84], axis=1)
        apart = np.abs(np.median(shades[:, own], axis=1) - middle)
        contrast = float((apart / ((high - low) / 2 + _SHADE_ERROR)).max())
    return Protrusion(rise, max(base - dip, _LEAST_NOISE * band), contrast)
