"""Which observation is of which thing: optimal assignment, in steps from the surest on."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from typing import NamedTuple, TypeVar

import numpy as np
from scipy.optimize import linear_sum_assignment

from nodes.perception_node.config import TrackingConfig
from nodes.perception_node.kinship import Kinship
from nodes.perception_node.likeness import Target, cost_anywhere, cost_in_place, size_unlike
from nodes.perception_node.overlap import Place, are_of_one, share
from nodes.perception_node.tracks import Track
from nodes.perception_node.visibility import Looks, Sight
from schemas.perception import Observation

A = TypeVar("A")
B = TypeVar("B")
K = TypeVar("K", str, int)
Cost = Callable[[Target, Observation, Kinship], float]

_PROHIBITIVE = 1e6
_COVERED = 0.6
"""A thing of which this share is in a segment's box may be a part of the segment."""
_FILLED = 0.2
"""Its parts fill this share of a segment's box: that of a table holds what lies on it, but not much of it."""
_LIKE = 0.15


class Candidate(NamedTuple):
    """Something that may be seen: what is remembered of it, and what it should look like."""

    track: Track
    target: Target


class Matching(NamedTuple):
    """Which observation, by its number, is of which entity and of which of those that are none yet.

    `places` tells of each entity that was not seen what is seen of its place; `odd` are those of them in
    whose place something of another size is seen. `new` are the observations of nothing known.
    """

    known: dict[str, int]
    tentative: dict[int, int]
    places: dict[str, Sight]
    odd: set[str]
    new: list[int]


def match(
    known: Mapping[str, Candidate],
    tentative: Sequence[Candidate],
    observations: Sequence[Observation],
    looks: Looks,
    kinship: Kinship,
    config: TrackingConfig,
) -> Matching:
    """Things in their places first; then what vanished, found elsewhere; then what is no entity yet."""

    def pairs(of: Mapping[K, Candidate], to: Collection[int], cost: Cost) -> dict[K, int]:
        free = sorted(to)
        targets, seen = [c.target for c in of.values()], [observations[j] for j in free]
        found = assign(targets, seen, lambda target, o: cost(target, o, kinship))
        return {list(of)[a]: free[b] for a, b in found}

    there = {name: c for name, c in known.items() if not c.track.unseen}
    single = {j for j, o in enumerate(observations) if not _is_of_several(o, there.values())}
    seen = pairs(there, single, cost_in_place)
    places = {name: _look_at(c.target, looks) for name, c in known.items() if name not in seen}
    rest = single.difference(seen.values())
    parts = {
        name: {j for j in rest if _may_be_of(c.target, observations[j])}
        for name, c in known.items()
        if places.get(name) != "open"
    }
    gone = {name for name in places if known[name].track.is_gone(config)}
    standing = [name for name in parts if name in there and name not in gone]
    left = rest.difference(*(parts[name] for name in standing))
    relatives = {
        j
        for name in standing
        for j in parts[name]
        if kinship.related(known[name].target.class_, observations[j].class_)
    }
    vanished = {
        name: known[name]
        for name, sight in places.items()
        if sight == "open" or name in gone or name not in there
    }
    found = pairs(vanished, rest - relatives, cost_anywhere)
    again = pairs(dict(enumerate(tentative)), left.difference(found.values()), cost_in_place)
    unseen = places.keys() - found.keys()
    for name in unseen:
        others = {*found.values(), *(seen.values() if name not in there else ())}
        if any(_may_be_of(known[name].target, observations[j]) for j in others):
            places[name] = "open"  # to itself: another has come to stand there
    return Matching(
        known=seen | found,
        tentative=again,
        places={name: places[name] for name in unseen},
        odd={name for name in unseen if places[name] == "filled" and parts[name]},
        new=sorted(left.difference(found.values(), again.values())),
    )


def assign(rows: Sequence[A], columns: Sequence[B], cost: Callable[[A, B], float]) -> list[tuple[int, int]]:
    """Pairs (row, column), as many as may be and of the least cost together; infinite ones never."""
    costs = np.array([[cost(a, b) for b in columns] for a in rows]).reshape(len(rows), len(columns))
    pairs = zip(*linear_sum_assignment(np.minimum(costs, _PROHIBITIVE)), strict=True)
    return [(int(i), int(j)) for i, j in pairs if costs[i, j] < _PROHIBITIVE]


def _look_at(target: Target, looks: Looks) -> Sight:
    """Of a thing of unknown size nobody can tell whether it is there."""
    return "hidden" if target.place is None else looks(*target.place)


def _is_of_several(seen: Observation, known: Iterable[Candidate]) -> bool:
    """Whether a segment is made of several things: it covers their places, which fill it; it is like none."""
    whole = Place(seen.pose, seen.size_m)
    covered = [
        (c.target, place)
        for c in known
        if (place := c.target.place) is not None and share(place, whole) > _COVERED
    ]
    volume_m3 = sum(place.volume_m3 for _, place in covered)
    return (
        len(covered) > 1
        and volume_m3 > _FILLED * whole.volume_m3
        and all(size_unlike(target, seen) > _LIKE for target, _ in covered)
    )


def _may_be_of(target: Target, seen: Observation) -> bool:
    return target.place is not None and are_of_one(target.place, Place(seen.pose, seen.size_m))
