"""Pairs of neighbours that perception cut out of simulated scenes: are they pieces of one thing?"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from nodes.perception_node.pipeline import Parts, parts_in
from nodes.perception_node.recognition.features import features_of
from nodes.perception_node.recognition.joining import between, near
from nodes.perception_node.sights import Sight
from nodes.training.samples import NOTHING, shared_pixels, view_sets
from nodes.training.scenes import Item, Shot


@dataclass(frozen=True)
class Pairs:
    """N pairs. `kinds`: (N, 2) the models, `NOTHING` for none. `one`: (N,) whether they are one thing.

    `geometry`, `shape`, `colour`: (N, 3, D) features of either and of both together. `known`: (N, 16), see
    `joining.between`.
    """

    kinds: NDArray[np.str_]
    one: NDArray[np.bool_]
    geometry: NDArray[np.float64]
    shape: NDArray[np.float64]
    colour: NDArray[np.float64]
    known: NDArray[np.float64]

    def __getitem__(self, rows: NDArray[np.bool_] | NDArray[np.int64]) -> Pairs:
        return Pairs(*(getattr(self, field.name)[rows] for field in fields(self)))


def joined(parts: Sequence[Pairs]) -> Pairs:
    """All pairs of all parts."""
    return Pairs(*(np.concatenate([getattr(p, f.name) for p in parts]) for f in fields(Pairs)))


def pairs_of(shot: Shot, found: Sequence[Sight], items: Sequence[Item]) -> list[Pairs]:
    """All neighbours in what perception cut out, by all cameras together and by each alone."""
    kind = {item.name: item.label for item in items}
    kinds = np.array([NOTHING, *(kind[body.name] for body in shot.bodies)])
    pairs = []
    for views in view_sets(len(found)):
        parts = parts_in([found[v] for v in views])
        neighbours = near(parts.things)
        if neighbours:
            owners = shared_pixels(parts, shot, views)[1:].argmax(axis=1)[np.array(neighbours)]
            pairs.append(_described(parts, neighbours, owners, kinds))
    return pairs


def _described(
    parts: Parts, pairs: Sequence[tuple[int, int]], owners: NDArray[np.int64], kinds: NDArray[np.str_]
) -> Pairs:
    """`owners`: (N, 2) the body that most pixels of each see, 0 for none; `kinds`: (B + 1,) what each is."""
    threes = [
        (parts.things[a], parts.things[b], parts.join(parts.things[a], parts.things[b])) for a, b in pairs
    ]
    features = features_of([thing for three in threes for thing in three])
    geometry, shape, colour = (values.reshape(len(pairs), 3, -1) for values in features)
    return Pairs(
        kinds=kinds[owners],
        one=(owners[:, 0] == owners[:, 1]) & (owners[:, 0] > 0),
        geometry=geometry,
        shape=shape,
        colour=colour,
        known=np.array(
            [
                between(*three, parts.held_for_one[:, [a]][:, :, [b]])
                for three, (a, b) in zip(threes, pairs, strict=True)
            ]
        ),
    )
