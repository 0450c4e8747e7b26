"""What of two patches tells whether they are one object."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from nodes.perception_node.segmentation import statistics as s
from nodes.perception_node.segmentation.statistics import Indices, Statistics

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
"""The columns of `features`, in order. `small` and `big` are the two patches, by their cells."""

_SUPPORT_M = 0.02
_UNKNOWN = -1.0  # lower than any that is known, so that a tree can ask for it


def candidates(statistics: Statistics, reach_m: float = 0.35) -> NDArray[np.bool_]:
    """(P, P) which pairs may be one object: near in the picture, or parted by something in front."""
    between = statistics.between
    wide = between[..., s.WIDE] + between[..., s.TOUCH] > 0
    middles = statistics.inside[:, s.POINT] / statistics.inside[:, s.COUNT, None]
    near = np.linalg.norm(middles[:, None] - middles[None], axis=-1) < reach_m
    may: NDArray[np.bool_] = wide | (near & (between[..., s.BLOCKED] > 0))
    np.fill_diagonal(may, False)
    return may


def features(of: Statistics, a: Indices, b: Indices) -> NDArray[np.float32]:
    """(N, len(NAMES)) of the pairs of patches (a, b), the same whichever stands first."""
    count_a, count_b = of.inside[a, s.COUNT], of.inside[b, s.COUNT]
    swap = (count_a < count_b) | ((count_a == count_b) & (a > b))
    big, small = np.where(swap, b, a), np.where(swap, a, b)
    many, few = of.inside[big], of.inside[small]
    count_big, count_small = many[:, s.COUNT], few[:, s.COUNT]
    border, back = of.between[small, big], of.between[big, small]
    root = np.sqrt(count_small)
    touch = np.maximum(border[:, s.TOUCH], 1)
    bends = np.maximum(border[:, s.BENDS], 1)
    sight = np.maximum(border[:, s.SIGHT], 1)
    middle_big, spread_big, normal_big = _shape(many)
    middle_small, spread_small, normal_small = _shape(few)
    _, spread_both, _ = _shape(many + few)
    apart = middle_big - middle_small
    distance = np.maximum(np.linalg.norm(apart, axis=1), 1e-6)
    straight_big = np.maximum(np.linalg.norm(normal_big, axis=1), 1e-6)
    straight_small = np.maximum(np.linalg.norm(normal_small, axis=1), 1e-6)
    unit_big, unit_small = normal_big / straight_big[:, None], normal_small / straight_small[:, None]
    low = np.minimum(of.low[big], of.low[small])
    high = np.maximum(of.high[big], of.high[small])
    sides = high[:, :2] - low[:, :2]
    area_big = np.prod(of.high[big, :2] - of.low[big, :2], axis=1)
    area_small = np.prod(of.high[small, :2] - of.low[small, :2], axis=1)
    columns = [
        *(np.log(count_small), np.log(count_big), count_small / count_big),
        *(border[:, s.TOUCH] / root, border[:, s.STEP] / touch),
        *(border[:, s.BEFORE] / touch, back[:, s.BEFORE] / touch),
        *(border[:, s.WIDE] / root, border[:, s.BENDS] / np.maximum(border[:, s.WIDE], 1)),
        *(border[:, s.BEND] / bends, border[:, s.CONCAVE] / bends, border[:, s.DEEP] / bends),
        *(border[:, s.CONVEX] / bends, border[:, s.LIKE] / bends),
        *(spread_small[:, 0], spread_big[:, 0], spread_both[:, 0]),
        *(spread_both[:, 0] - np.maximum(spread_small[:, 0], spread_big[:, 0]), spread_both[:, 2]),
        *(straight_small, straight_big, (unit_big * unit_small).sum(axis=1)),
        *((unit_big * apart).sum(axis=1), -(unit_small * apart).sum(axis=1)),
        ((normal_big - normal_small) * apart).sum(axis=1) / distance,
        *(border[:, s.SIGHT], border[:, s.BLOCKED] / sight, border[:, s.OPEN] / sight),
        *(few[:, s.HIDDEN] / root, many[:, s.HIDDEN] / np.sqrt(count_big), distance),
        *(_above_support(of, small), of.high[small, 2] - of.low[small, 2]),
        *(_above_support(of, big), of.high[big, 2] - of.low[big, 2]),
        *(of.low[small, 2] - of.high[big, 2], of.low[big, 2] - of.high[small, 2]),
        np.minimum(of.high[small, 2], of.high[big, 2]) - np.maximum(of.low[small, 2], of.low[big, 2]),
        *(np.abs(of.high[small, 2] - of.high[big, 2]), np.abs(of.low[small, 2] - of.low[big, 2])),
        *(sides.max(axis=1), sides.min(axis=1), high[:, 2] - low[:, 2]),
        (area_big + area_small) / np.maximum(np.prod(sides, axis=1), 1e-6),
        area_small / np.maximum(area_big, 1e-6),
        *_colours(few, many, border),
    ]
    return np.stack(columns, axis=1).astype(np.float32)


def _colours(few: s.Sums, many: s.Sums, border: s.Sums) -> list[s.Sums]:
    """How unlike the colours are, as a whole and along the border, and how mixed each is; -1 if unknown."""
    shades = [of[:, s.SHADE] / of[:, s.COUNT, None] for of in (few, many)]
    turned = np.abs(shades[0] - shades[1])
    mottled = [
        np.sqrt(np.maximum(of[:, s.SHADES] / of[:, s.COUNT] - (shade[:, 1:] ** 2).sum(axis=1), 0))
        for of, shade in zip((few, many), shades, strict=True)
    ]
    bends = np.where(border[:, s.BENDS] > 0, border[:, s.BENDS], np.nan)
    there = [border[:, column] / bends for column in (s.BRIGHTER, s.COLOURED)]
    known = (turned[:, 0], np.hypot(turned[:, 1], turned[:, 2]), *there, *mottled)
    return [np.nan_to_num(column, nan=_UNKNOWN) for column in known]


def _shape(sums: s.Sums) -> tuple[s.Sums, s.Sums, s.Sums]:
    """Middle [m], standard deviations along the main axes from the least [m], mean normal: (N, 3) each."""
    count = sums[:, s.COUNT, None]
    middle = sums[:, s.POINT] / count
    xx, yy, zz, xy, xz, yz = (sums[:, s.SQUARES] / count).T
    squares = np.stack([xx, xy, xz, xy, yy, yz, xz, yz, zz], axis=1).reshape(-1, 3, 3)
    covariance = squares - middle[:, :, None] * middle[:, None, :]
    spread = np.sqrt(np.maximum(np.linalg.eigvalsh(covariance), 1e-10))
    return middle, spread, sums[:, s.NORMAL] / count


def _above_support(of: Statistics, patches: Indices) -> s.Sums:
    """(N,) how far the lowest points of patches are above what carries things beneath them [m]."""
    if not of.supports.size:
        return np.zeros(len(patches))
    low = of.low[patches, 2]
    beneath = np.searchsorted(of.supports, low + _SUPPORT_M) - 1
    above: s.Sums = low - of.supports[np.maximum(beneath, 0)]
    return above
