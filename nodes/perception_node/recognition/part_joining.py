"""Joins pieces of things: together they are easier to recognise than apart."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from semmap.nodes.perception_node.recognition.features import features_of
from semmap.nodes.perception_node.recognition.joining import (
    describe_pair,
    is_worth_joining,
    near_pairs,
    same_thing_probability,
)
from semmap.nodes.perception_node.recognition.recognition_model import RecognitionModel
from semmap.nodes.perception_node.recognition.vote import leaf_probabilities
from semmap.nodes.perception_node.views.boxes import Numbers
from semmap.nodes.perception_node.views.merged_thing import Thing

_ROUNDS = 8
_MOST_PAIRS = 16
_SURE = 0.5

Join = Callable[[Thing, Thing], Thing]
Members = tuple[int, ...]


def join_parts(
    things: Sequence[Thing], same_thing_logits: Numbers, learnt: RecognitionModel, join: Join
) -> tuple[list[Thing], Numbers, list[list[int]]]:
    """Join neighbours that are pieces of one thing, the most certain pair first.

    `same_thing_logits`: (2, N, N), see `fusion`. Returns the things, (N, K) probabilities of their leaves,
    and for each the numbers of `things` in it.
    """
    if not things:
        return [], np.empty((0, len(learnt.classes))), []
    parts = list(things)
    members: list[Members] = [(n,) for n in range(len(things))]
    chances = leaf_probabilities(learnt, features_of(parts))
    tried: dict[tuple[Members, Members], tuple[Thing, Numbers, float]] = {}
    for _ in range(_ROUNDS):
        close = near_pairs(parts)
        worth = is_worth_joining(chances[np.array(close, int).reshape(-1, 2)], learnt)
        pairs = [pair for pair, trying in zip(close, worth, strict=True) if trying][:_MOST_PAIRS]
        new = [(a, b) for a, b in pairs if (members[a], members[b]) not in tried]
        if new:
            wholes = [join(parts[a], parts[b]) for a, b in new]
            together = leaf_probabilities(learnt, features_of(wholes))
            known = np.array(
                [
                    describe_pair(
                        parts[a], parts[b], whole, same_thing_logits[:, members[a]][:, :, members[b]]
                    )
                    for (a, b), whole in zip(new, wholes, strict=True)
                ]
            )
            likely = same_thing_probability(chances[np.array(new)], together, known, learnt).tolist()
            for (a, b), whole, chance, one in zip(new, wholes, together, likely, strict=True):
                tried[members[a], members[b]] = whole, chance, one
        sure = [tried[members[a], members[b]][2] for a, b in pairs]
        if max(sure, default=0.0) < _SURE:
            break
        a, b = pairs[int(np.argmax(sure))]
        parts[a], chances[a], _ = tried[members[a], members[b]]
        members[a] += members[b]
        del parts[b], members[b]
        chances = np.delete(chances, b, axis=0)
    return parts, chances, [list(numbers) for numbers in members]
