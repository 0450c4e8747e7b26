"""Relations as they are in a world at rest, from forces and samples. Borderline cases are left open."""

from __future__ import annotations

from collections.abc import Callable
from itertools import permutations
from typing import NamedTuple

import numpy as np

from benchmarks.relations.foreign.drawing import Hollow
from benchmarks.relations.foreign.settling import AtRest, Floats, extents_at

Pair = tuple[str, str]
Verdicts = dict[Pair, bool | None]
"""Whether a relation holds, or None if it is a borderline case, which is not counted."""
_ACROSS, _ALONG = 32, 10
"""Samples of a thing along each side of its footprint, and along a vertical line in a part."""
_CARRIED = (0.05, 0.2)
"""A support carries at least the larger share of a thing's weight; below the smaller one it is none."""
_WITHIN = (0.4, 0.6)
"""The same for shares of a volume, or of a foot, in a hollow."""
_COVERED = (0.22, 0.4)
"""The same for shares of the smaller footprint under parts of the other."""
_FOOT = 0.1
"""The foot of a thing, as a share of its height."""
_TOLERANCE_M = 0.005


class Truth(NamedTuple):
    """The verdicts on all pairs of things of a world."""

    on: Verdicts
    inside: Verdicts
    under: Verdicts


def find_truth(rest: AtRest) -> Truth:
    """Return the relations of a world at rest."""
    inside = _find_inside(rest)
    pairs = list(permutations(rest.things, 2))
    on = {pair: _find_support(rest, pair, inside[pair]) for pair in pairs}
    for one, relation, other in rest.world.stated:
        (on if relation == "isOn" else inside)[one, other] = True
    carried = _list_carried([pair for pair in pairs if on[pair] is not False or inside[pair] is not False])
    under = {pair: _find_under(rest, *pair, carried) for pair in pairs}
    return Truth(on, inside, under)


def _find_support(rest: AtRest, pair: Pair, is_inside: bool | None) -> bool | None:
    upper, _ = pair
    if is_inside is not False:
        return None if is_inside is None else False
    return _judge(rest.lifted.get(pair, 0.0), _CARRIED) if upper in rest.falling else False


def _find_inside(rest: AtRest) -> Verdicts:
    """Return the pairs of a thing and the smallest hollow that holds it."""
    owners, hollows = rest.world.owners(), rest.world.hollows()
    found: Verdicts = {}
    for thing in rest.things:
        points = _sample(rest, thing)
        height = np.ptp(points[:, 2])
        foot = points[points[:, 2] <= points[:, 2].min() + _FOOT * height]
        best: dict[str, tuple[bool | None, float]] = {}
        for hollow in hollows:
            outer = owners[hollow.body]
            if outer == thing:
                continue
            made = _judge(float(_is_in(rest, hollow, points).mean()), _WITHIN)
            if not made and hollow.size[2] >= 0.2 * min(hollow.size[:2]):
                low = hollow._replace(size=(*hollow.size[:2], hollow.size[2] / 2))
                made = _judge(float(_is_in(rest, low, foot).mean()), _WITHIN) or made
            volume = float(np.prod(hollow.size))
            if made is not False and (outer not in best or volume < best[outer][1]):
                best[outer] = (made, volume)
        smallest = min((volume for made, volume in best.values() if made), default=np.inf)
        for outer in rest.things:
            verdict, volume = best.get(outer, (False, 0.0))
            found[thing, outer] = verdict if volume <= smallest else False
    return found


def _is_in(rest: AtRest, hollow: Hollow, points: Floats) -> Floats:
    """Return (N,) whether (N, 3) points are in a hollow."""
    body = rest.data.body(hollow.body)
    own = (points - body.xpos) @ body.xmat.reshape(3, 3) - hollow.at
    across = np.abs(own[:, :2]) / np.multiply(hollow.size[:2], 0.5)
    level = (own[:, 2] >= -_TOLERANCE_M) & (own[:, 2] <= hollow.size[2])
    walls = np.hypot(*across.T) if hollow.round else across.max(axis=1)
    found: Floats = (walls <= 1.0 + 1e-6) & level
    return found


def _grid(rest: AtRest, thing: str) -> Floats:
    """Return points of a grid over the bounds of a thing, seen from above."""
    low, high = rest.bounds[thing]
    steps = (np.arange(_ACROSS) + 0.5) / _ACROSS
    x, y = (low[k] + steps * (high[k] - low[k]) for k in (0, 1))
    return np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)


def _sample(rest: AtRest, thing: str) -> Floats:
    """Return points evenly spread over the parts of a thing."""
    grid = _grid(rest, thing)
    found = []
    for hull in rest.hulls[thing]:
        low, high = (ends[0] for ends in extents_at([hull], grid))
        there = np.isfinite(low)
        if not there.any():
            continue
        count = np.ceil(
            (high[there] - low[there]) / max(np.ptp(np.r_[low[there], high[there]]), 1e-9) * _ALONG
        )
        for (x, y), z0, z1, n in zip(grid[there], low[there], high[there], count.astype(int), strict=True):
            steps = z0 + (np.arange(n) + 0.5) / n * (z1 - z0)
            found.append(np.c_[np.full(n, x), np.full(n, y), steps])
    return np.vstack(found)


def _find_under(rest: AtRest, lower: str, upper: str, carried: set[Pair]) -> bool | None:
    """Return whether parts of `upper` are over `lower`.

    A thing in a cupboard, or on a tray on a shelf, has boards of these above it. This is left open, and that
    a table is under what is on its tray.
    """
    low, high = rest.bounds[lower]
    (its_low, its_high), areas = rest.bounds[upper], [_area(rest, lower), _area(rest, upper)]
    if ((high < its_low).any() and (high < its_low)[:2].any()) or (its_high < low)[:2].any():
        return False
    smaller = lower if areas[0] < areas[1] else upper
    grid = _grid(rest, smaller)
    tops = _fold(np.fmax.reduce, extents_at(rest.hulls[lower], grid)[1])
    bottoms = extents_at(rest.hulls[upper], grid)[0]
    with np.errstate(invalid="ignore"):
        over = (bottoms >= tops - _TOLERANCE_M).any(axis=0)
    counted = np.isfinite(extents_at(rest.hulls[smaller], grid)[0]).any(axis=0)
    made = _judge(float(over.sum() / max(1, counted.sum())), _COVERED)
    if made is False:
        return False
    return None if (lower, upper) in carried or (upper, lower) in carried else made


def _fold(by: Callable[..., Floats], values: Floats) -> Floats:
    return by(values, axis=0)


def _area(rest: AtRest, thing: str) -> float:
    low, high = rest.bounds[thing]
    return float(np.prod((high - low)[:2]))


def _list_carried(direct: list[Pair]) -> set[Pair]:
    """Return the pairs of a thing and what it is on or in, at any depth."""
    found, added = set(direct), set(direct)
    while added:
        added = {(a, d) for a, b in added for c, d in direct if b == c} - found
        found |= added
    return found


def _judge(share: float, limits: tuple[float, float]) -> bool | None:
    return False if share < limits[0] else True if share >= limits[1] else None
