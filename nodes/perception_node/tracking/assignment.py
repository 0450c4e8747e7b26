"""Optimal assignment of observations to things, in steps from the most certain one."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from typing import NamedTuple, TypeVar

import numpy as np
from scipy.optimize import linear_sum_assignment

from semmap.nodes.perception_node.config import TrackingConfig
from semmap.nodes.perception_node.tracking.class_hierarchy import ClassHierarchy
from semmap.nodes.perception_node.tracking.costs import (
    FORBIDDEN,
    Target,
    cost_anywhere,
    cost_in_place,
    cost_nearby,
    cost_of_height,
    size_difference,
)
from semmap.nodes.perception_node.tracking.observed_images import NO_IMAGES, ObservedImages
from semmap.nodes.perception_node.tracking.occupancy import Occupancy, OccupancyOf
from semmap.nodes.perception_node.tracking.overlap import OrientedBox, may_be_same_thing, share
from semmap.nodes.perception_node.tracking.tracks import Track
from semmap.schemas.entities import distance_m
from semmap.schemas.perception import Observation

A = TypeVar("A")
B = TypeVar("B")
K = TypeVar("K", str, int)

_PROHIBITIVE = 1e6
_COVERED = 0.6
"""A thing with this share inside a segment's box may be a part of the segment."""
_FILLED = 0.2
"""Parts fill this share of a segment's box.

The box of a table contains what lies on it, but is not filled by it.
"""
_LIKE = 0.15
_LARGE_M = 0.4
"""Larger things are not carried."""


class Candidate(NamedTuple):
    """A thing that may be visible: its track, and its expected appearance."""

    track: Track
    target: Target


class Matching(NamedTuple):
    """The observation, by index, of each entity and each tentative track.

    `occupancy` is what is seen in the box of each entity that was not observed; `odd` are those with
    something of another size in their box. `new` are the observations of nothing known.
    """

    known: dict[str, int]
    tentative: dict[int, int]
    occupancy: dict[str, Occupancy]
    odd: set[str]
    new: list[int]


def match(
    known: Mapping[str, Candidate],
    tentative: Sequence[Candidate],
    observations: Sequence[Observation],
    occupancy_of: OccupancyOf,
    classes: ClassHierarchy,
    config: TrackingConfig,
    images: ObservedImages = NO_IMAGES,
) -> Matching:
    """Match things in their places first, then vanished things elsewhere, then tentative tracks."""

    def pairs(
        of: Mapping[K, Candidate], to: Collection[int], cost: Callable[[K, int], float]
    ) -> dict[K, int]:
        keys, free = list(of), sorted(to)
        return {keys[a]: free[b] for a, b in assign(keys, free, cost)}

    def in_place(of: Mapping[K, Candidate]) -> Callable[[K, int], float]:
        return lambda key, j: cost_in_place(of[key].target, observations[j], classes)

    there = {name: c for name, c in known.items() if c.track.unseen < config.vanished_frames}
    single = {j for j, o in enumerate(observations) if not _is_of_several(o, there.values())}
    seen = pairs(there, single, in_place(there))
    rest = single.difference(seen.values())
    occupancy = {
        name: "occupied"
        if any(_shows_a_part(c.target, observations[j], classes) for j in rest)
        else _occupancy(c.target, occupancy_of)
        for name, c in known.items()
        if name not in seen
    }
    odd = {name: known[name] for name in occupancy if known[name].track.is_nearly_odd(config)}
    corrected = pairs(odd, rest, lambda name, j: cost_of_height(odd[name].target, observations[j], classes))
    seen, rest = seen | corrected, rest.difference(corrected.values())
    occupancy = {name: found for name, found in occupancy.items() if name not in corrected}
    parts = {
        name: {j for j in rest if _may_be_of(c.target, observations[j])}
        for name, c in known.items()
        if occupancy.get(name) != "free"
    }
    gone = {name for name in occupancy if known[name].track.is_gone(config)}
    standing = [name for name in parts if name in there and name not in gone]
    left = rest.difference(*(parts[name] for name in standing))
    relatives = {
        j
        for name in standing
        for j in parts[name]
        if classes.related(known[name].target.class_, observations[j].class_)
    }
    vanished = {
        name: known[name]
        for name, seen_there in occupancy.items()
        if name in gone or known[name].track.unseen + (seen_there == "free") >= config.vanished_frames
    }
    others = dict(enumerate(tentative))
    looks = {j: others[i].track.frames for i, j in pairs(others, rest, in_place(others)).items()}

    def may_have_moved(name: str, j: int) -> bool:
        was_there_before = looks.get(j, 0) > known[name].track.absent
        return not was_there_before and known[name].target.whole

    def elsewhere(name: str, j: int) -> float:
        target = known[name].target
        if not may_have_moved(name, j) or _is_too_far(target, observations[j], config):
            return FORBIDDEN
        return cost_anywhere(target, observations[j], classes, images.compare(known[name].track, j))

    def in_front(name: str, j: int) -> float:
        if not may_have_moved(name, j):
            return FORBIDDEN
        return cost_nearby(known[name].target, observations[j], classes, config.hidden_m)

    found = pairs(vanished, rest - relatives, elsewhere)
    hidden = {
        name: known[name]
        for name, seen_there in occupancy.items()
        if config.still_camera and seen_there == "unknown" and name not in vanished
    }
    found |= pairs(hidden, left - relatives - {*found.values()}, in_front)
    again = pairs(others, left.difference(found.values()), in_place(others))
    unseen = occupancy.keys() - found.keys()
    for name in unseen:
        taken = {*found.values(), *(seen.values() if name not in there else ())}
        if any(_may_be_of(known[name].target, observations[j]) for j in taken):
            occupancy[name] = "free"  # another thing has taken its place
    return Matching(
        known=seen | found,
        tentative=again,
        occupancy={name: occupancy[name] for name in unseen},
        odd={name for name in unseen if occupancy[name] == "occupied" and parts[name]},
        new=sorted(left.difference(found.values(), again.values())),
    )


def assign(rows: Sequence[A], columns: Sequence[B], cost: Callable[[A, B], float]) -> list[tuple[int, int]]:
    """Return as many pairs (row, column) as possible with minimum total cost; infinite costs are excluded.

    The assignment problem is solved by SciPy (Jonker-Volgenant).
    """
    costs = np.array([[cost(a, b) for b in columns] for a in rows]).reshape(len(rows), len(columns))
    pairs = zip(*linear_sum_assignment(np.minimum(costs, _PROHIBITIVE)), strict=True)
    return [(int(i), int(j)) for i, j in pairs if costs[i, j] < _PROHIBITIVE]


def _occupancy(target: Target, occupancy_of: OccupancyOf) -> Occupancy:
    """Return the occupancy of a thing's box; unknown for a thing of unknown size."""
    return "unknown" if target.box is None else occupancy_of(*target.box)


def _is_of_several(seen: Observation, known: Iterable[Candidate]) -> bool:
    """Return whether a segment consists of several things: it covers their boxes and is like none of them."""
    whole = OrientedBox(seen.pose, seen.size_m)
    covered = [
        (c.target, box) for c in known if (box := c.target.box) is not None and share(box, whole) > _COVERED
    ]
    volume_m3 = sum(box.volume_m3 for _, box in covered)
    return (
        len(covered) > 1
        and volume_m3 > _FILLED * whole.volume_m3
        and all(size_difference(target, seen) > _LIKE for target, _ in covered)
    )


def _is_too_far(target: Target, seen: Observation, config: TrackingConfig) -> bool:
    """Return whether something large would have been pushed too far."""
    return max(seen.size_m) > _LARGE_M and distance_m(target.pose, seen.pose) > config.pushed_m


def _shows_a_part(target: Target, seen: Observation, classes: ClassHierarchy) -> bool:
    """Return whether an observation is probably of the thing, so that its place is not empty.

    Through things with thin legs, a camera sees much of what is behind them.
    """
    return (not seen.whole or classes.related(target.class_, seen.class_)) and _may_be_of(target, seen)


def _may_be_of(target: Target, seen: Observation) -> bool:
    return target.box is not None and may_be_same_thing(target.box, OrientedBox(seen.pose, seen.size_m))
