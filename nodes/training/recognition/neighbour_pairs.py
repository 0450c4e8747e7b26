"""Pairs of neighbouring segments in simulated scenes, with whether they belong to one thing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components

from semmap.nodes.perception_node.pipeline import Parts, parts_in
from semmap.nodes.perception_node.recognition.features import SORTS, features_of
from semmap.nodes.perception_node.recognition.joining import describe_pair, near_pairs
from semmap.nodes.perception_node.views.segmented_view import segment_cloud
from semmap.nodes.training.recognition.array_tables import Table
from semmap.nodes.training.recognition.samples import NOTHING, shared_pixels, view_sets
from semmap.nodes.training.scenes.simulated_scenes import Item, Shot

_JOINED = 0.5

Members = tuple[int, ...]


@dataclass(frozen=True)
class Pairs(Table):
    """N pairs. `kinds`: (N, 2) the models, `NOTHING` for none. `one`: (N,) whether they are one thing.

    `geometry`, `shape`, `colour`, `outline`, `relief`: (N, 3, D) features of either and of both together.
    `known`: (N, 16), see `joining.between`.
    """

    kinds: NDArray[np.str_]
    one: NDArray[np.bool_]
    geometry: NDArray[np.float64]
    shape: NDArray[np.float64]
    colour: NDArray[np.float64]
    outline: NDArray[np.float64]
    relief: NDArray[np.float64]
    known: NDArray[np.float64]


def pairs_of(shot: Shot, items: Sequence[Item], rng: np.random.Generator) -> list[Pairs]:
    """Return all pairs of neighbouring segments, for all cameras together and for each alone.

    Also those that are left when some pieces of one thing have been put together.
    """
    kind = {item.name: item.label for item in items}
    kinds = np.array([NOTHING, *(kind[body.name] for body in shot.bodies)])
    found = [segment_cloud(cloud) for cloud in shot.clouds]
    pairs = []
    for views in view_sets(len(found)):
        parts = parts_in([found[v] for v in views])
        owners = shared_pixels(parts, shot, views)[1:].argmax(axis=1)
        members = [(n,) for n in range(len(parts.things))]
        pairs += _described(parts, members, owners, kinds)
        some = _partly_joined(parts, owners, rng)
        if len(some) < len(members):
            pairs += _described(parts, some, owners, kinds)
    return pairs


def _partly_joined(parts: Parts, owners: NDArray[np.int64], rng: np.random.Generator) -> list[Members]:
    """Return the groups after randomly joining pairs that belong to one thing."""
    count = len(parts.things)
    joined = np.zeros((count, count), bool)
    for a, b in near_pairs(parts.things):
        joined[a, b] = owners[a] == owners[b] > 0 and rng.random() < _JOINED
    groups, group = connected_components(joined, directed=False)
    return [tuple(np.flatnonzero(group == n).tolist()) for n in range(groups)]


def _described(
    parts: Parts, members: Sequence[Members], owners: NDArray[np.int64], kinds: NDArray[np.str_]
) -> list[Pairs]:
    """`owners`: (N,) the body that most pixels of a part see, 0 for none; `kinds`: (B + 1,) of each body."""
    things = [reduce(parts.join, (parts.things[n] for n in numbers)) for numbers in members]
    pairs = near_pairs(things)
    if not pairs:
        return []
    threes = [(things[a], things[b], parts.join(things[a], things[b])) for a, b in pairs]
    features = features_of([thing for three in threes for thing in three])
    shown = {sort: values.reshape(len(pairs), 3, -1) for sort, values in zip(SORTS, features, strict=True)}
    owner = owners[[numbers[0] for numbers in members]][np.array(pairs)]
    held = [parts.same_thing_logits[:, members[a]][:, :, members[b]] for a, b in pairs]
    return [
        Pairs(
            kinds=kinds[owner],
            one=(owner[:, 0] == owner[:, 1]) & (owner[:, 0] > 0),
            **shown,
            known=np.array([describe_pair(*three, how) for three, how in zip(threes, held, strict=True)]),
        )
    ]
