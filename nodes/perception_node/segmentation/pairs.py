"""Features of pairs of patches that indicate whether they are one object."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.segmentation import statistics as s
from semmap.nodes.perception_node.segmentation.statistics import Indices, Statistics

NAMES = (
    *("log_small", "log_big", "ratio"),
    *("touch", "step", "small_before", "big_before"),
    *("wide", "bends", "bend", "concave", "deep", "convex", "like"),
    *("flat_small", "flat_big", "flat_both", "flatter", "long_both", "curved_small", "curved_big"),
    *("facing", "off_big", "off_small", "turned_out"),
    *("sight", "blocked", "open", "hidden_small", "hidden_big", "apart"),
    *("low_small", "tall_small", "low_big", "tall_big", "small_on_big", "big_on_small", "levels"),
    *("tops_apart", "bottoms_apart"),
    *("side_both", "width_both", "tall_both", "filled", "footprint"),
    *("brighter", "coloured", "brighter_there", "coloured_there", "mottled_small", "mottled_big"),
)
"""The columns of `features`, in order. `small` and `big` are the two patches, by number of cells."""

_SUPPORT_M = 0.02
_MATRIX = np.array([[0, 3, 4], [3, 1, 5], [4, 5, 2]])  # where the squares xx, yy, zz, xy, xz, yz go
_UNKNOWN = -1.0  # below all known values, so that a tree can test for it


def candidates(statistics: Statistics, reach_m: float = 0.35) -> NDArray[np.bool_]:
    """Return (P, P) which pairs may be one object: adjacent in the image, or separated by an occluder.

    More sight lines between two patches must end at an occluder than pass between them to what is behind.
    """
    between = statistics.between
    wide = between[..., s.WIDE] + between[..., s.TOUCH] > 0
    middles = statistics.inside[:, s.POINT] / statistics.inside[:, s.COUNT, None]
    near = np.linalg.norm(middles[:, None] - middles[None], axis=-1) < reach_m
    may: NDArray[np.bool_] = wide | (near & (between[..., s.BLOCKED] > between[..., s.OPEN]))
    np.fill_diagonal(may, False)
    return may


class Each(NamedTuple):
    """The values of N patches that are used in features of pairs.

    `middle`, `low`, `high`: (N, 3) [m]. `spread`: (N, 3) standard deviations along the main axes, ascending
    [m]. `normal`, `unit`: (N, 3) the mean normal, and normalised; `straight`: (N,) its length. `above`: (N,)
    height of the lowest point above the support [m]. `shade`: (N, 3) mean colour, `mottled`: (N,) its
    variation, both NaN if unknown.
    """

    sums: s.Sums
    cells: s.Sums
    middle: s.Sums
    spread: s.Sums
    normal: s.Sums
    unit: s.Sums
    straight: s.Sums
    low: s.Sums
    high: s.Sums
    above: s.Sums
    hidden: s.Sums
    shade: s.Sums
    mottled: s.Sums


def features(of: Statistics, a: Indices, b: Indices) -> NDArray[np.float32]:
    """Return features (N, len(NAMES)) of the pairs of patches (a, b), independent of their order."""
    counts = of.inside[:, s.COUNT]
    swap = (counts[a] < counts[b]) | ((counts[a] == counts[b]) & (a > b))
    first, second = np.where(swap, a, b), np.where(swap, b, a)
    each = _each(of)  # there are fewer patches than pairs
    small, big = (Each._make(column[rows] for column in each) for rows in (first, second))
    border, back = of.between[first, second].T, of.between[second, first].T
    root = np.sqrt(small.cells)
    touch, wide, bends, sight = np.maximum(border[[s.TOUCH, s.WIDE, s.BENDS, s.SIGHT]], 1)
    spread_both = _spread(small.sums + big.sums)
    apart = big.middle - small.middle
    distance = np.maximum(np.linalg.norm(apart, axis=1), 1e-6)
    low, high = np.minimum(small.low, big.low), np.maximum(small.high, big.high)
    sides = high - low
    footprint = sides[:, 0] * sides[:, 1]
    tall_small, tall_big = (of.high[:, 2] - of.low[:, 2] for of in (small, big))
    area_small, area_big = (np.prod(of.high[:, :2] - of.low[:, :2], axis=1) for of in (small, big))
    columns = [
        *(np.log(small.cells), np.log(big.cells), small.cells / big.cells),
        *(border[s.TOUCH] / root, border[s.STEP] / touch, border[s.BEFORE] / touch, back[s.BEFORE] / touch),
        *(border[s.WIDE] / root, border[s.BENDS] / wide),
        *(border[[s.BEND, s.CONCAVE, s.DEEP, s.CONVEX, s.LIKE]] / bends),
        *(small.spread[:, 0], big.spread[:, 0], spread_both[:, 0]),
        *(spread_both[:, 0] - np.maximum(small.spread[:, 0], big.spread[:, 0]), spread_both[:, 2]),
        *(small.straight, big.straight, (big.unit * small.unit).sum(axis=1)),
        *((big.unit * apart).sum(axis=1), -(small.unit * apart).sum(axis=1)),
        ((big.normal - small.normal) * apart).sum(axis=1) / distance,
        *(border[s.SIGHT], border[s.BLOCKED] / sight, border[s.OPEN] / sight),
        *(small.hidden, big.hidden, distance),
        *(small.above, tall_small, big.above, tall_big),
        *(small.low[:, 2] - big.high[:, 2], big.low[:, 2] - small.high[:, 2]),
        np.minimum(small.high[:, 2], big.high[:, 2]) - np.maximum(small.low[:, 2], big.low[:, 2]),
        *(np.abs(small.high[:, 2] - big.high[:, 2]), np.abs(small.low[:, 2] - big.low[:, 2])),
        *(np.maximum(sides[:, 0], sides[:, 1]), np.minimum(sides[:, 0], sides[:, 1]), sides[:, 2]),
        *((area_big + area_small) / np.maximum(footprint, 1e-6), area_small / np.maximum(area_big, 1e-6)),
        *_colours(small, big, border),
    ]
    return np.stack(columns, axis=1, dtype=np.float32, casting="same_kind")


def _each(of: Statistics) -> Each:
    """Compute the values of all patches."""
    sums = of.inside
    count = sums[:, s.COUNT]
    normal = sums[:, s.NORMAL] / count[:, None]
    straight = np.maximum(np.linalg.norm(normal, axis=1), 1e-6)
    shade = sums[:, s.SHADE] / count[:, None]
    return Each(
        sums=sums,
        cells=count,
        middle=sums[:, s.POINT] / count[:, None],
        spread=_spread(sums),
        normal=normal,
        unit=normal / straight[:, None],
        straight=straight,
        low=of.low,
        high=of.high,
        above=_above_support(of),
        hidden=sums[:, s.HIDDEN] / np.sqrt(count),
        shade=shade,
        mottled=np.sqrt(np.maximum(sums[:, s.SHADES] / count - (shade[:, 1:] ** 2).sum(axis=1), 0)),
    )


def _colours(small: Each, big: Each, border: s.Sums) -> list[s.Sums]:
    """Return differences of colours, overall and along the border, and their variation; -1 if unknown."""
    turned = np.abs(small.shade - big.shade)
    bends = np.where(border[s.BENDS] > 0, border[s.BENDS], np.nan)
    there = border[[s.BRIGHTER, s.COLOURED]] / bends
    known = (turned[:, 0], np.hypot(turned[:, 1], turned[:, 2]), *there, small.mottled, big.mottled)
    return [np.where(np.isnan(column), _UNKNOWN, column) for column in known]


def _spread(sums: s.Sums) -> s.Sums:
    """Return (N, 3) standard deviations along the main axes, ascending [m]."""
    means = sums / sums[:, s.COUNT, None]
    middle = means[:, s.POINT]
    covariance = means[:, s.SQUARES][:, _MATRIX] - middle[:, :, None] * middle[:, None, :]
    return np.asarray(np.sqrt(np.maximum(np.linalg.eigvalsh(covariance), 1e-10)))


def _above_support(of: Statistics) -> s.Sums:
    """Return (P,) the height of the lowest points of patches above their support [m]."""
    low = of.low[:, 2]
    if not of.supports.size:
        return np.zeros(len(low))
    beneath = np.searchsorted(of.supports, low + _SUPPORT_M) - 1
    above: s.Sums = low - of.supports[np.maximum(beneath, 0)]
    return above
