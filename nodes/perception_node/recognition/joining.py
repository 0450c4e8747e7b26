"""Joins neighbours that are pieces of one thing, because the whole is easier to recognise."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.input.cloud import Floats
from semmap.nodes.perception_node.recognition.features import features_of
from semmap.nodes.perception_node.recognition.recognition_model import CLUTTER, UNKNOWN, RecognitionModel
from semmap.nodes.perception_node.recognition.vote import leaf_probabilities
from semmap.nodes.perception_node.views.boxes import Numbers
from semmap.nodes.perception_node.views.merged_thing import Thing

_BESIDE_M = 0.04
_ABOVE_M = 0.2
"""Maximum gap between a lamp's shade and its foot: the thin part between them is not visible."""

_DOUBTFUL = 0.95
_PIECE = 0.5
_LEAST = 1e-3
_ROUNDS = 8
_MOST_PAIRS = 16
_SURE = 0.5
Join = Callable[[Thing, Thing], Thing]
Members = tuple[int, ...]


def near_pairs(things: Sequence[Thing], beside_m: float = _BESIDE_M) -> list[tuple[int, int]]:
    """Return pairs (a, b), a < b, that are closer than `beside_m` or above one another.

    Table tops are excluded, and pairs that an external detector separates.
    """
    low = np.array([thing.cells.min(axis=0) for thing in things]).reshape(-1, 3)
    high = np.array([thing.cells.max(axis=0) for thing in things]).reshape(-1, 3)
    small = np.array([not thing.carrier for thing in things], dtype=bool)
    apart = np.maximum(low[:, None] - high, low - high[:, None])
    masked = np.array([thing.masked for thing in things], dtype=bool)
    close = (apart < [beside_m, beside_m, _ABOVE_M]).all(axis=2) & small & small[:, None]
    close &= ~(masked & masked[:, None])
    return [(int(a), int(b)) for a, b in np.argwhere(np.triu(close, 1))]


def describe_pair(a: Thing, b: Thing, whole: Thing, same_thing_logits: Numbers) -> NDArray[np.float64]:
    """Return features (16,) of a pair before recognition.

    These are the logarithms of both point counts, the gaps beside and above, how empty the joint box is, how
    likely cameras see one thing, and the logarithms of long side, short side and height of a, b and both.
    `same_thing_logits`: (2, A, B) of the parts of a and b, see `fusion`.
    """
    gap = np.maximum(a.cells.min(axis=0) - b.cells.max(axis=0), b.cells.min(axis=0) - a.cells.max(axis=0))
    sizes = np.array([[*np.sort(thing.box.size_m[:2])[::-1], thing.box.size_m[2]] for thing in (a, b, whole)])
    volumes = sizes.prod(axis=1)
    return np.array(
        [
            np.log(a.count),
            np.log(b.count),
            gap[:2].max(),
            gap[2],
            np.log(volumes[2] / volumes[:2].sum()),
            same_thing_logits[0].min(),
            same_thing_logits[1].max(),
            *np.log(sizes).ravel(),
        ]
    )


def is_worth_joining(apart: Numbers, learnt: RecognitionModel) -> NDArray[np.bool_]:
    """Return (N,) whether one of two things (N, 2, K) is uncertain, or both have the same class."""
    known = apart[..., nameable(learnt)]
    doubtful = (known.max(axis=2) < _DOUBTFUL) | (apart[..., learnt.classes.index(CLUTTER)] > _PIECE)
    best = known.argmax(axis=2)
    return np.asarray(doubtful.any(axis=1) | (best[:, 0] == best[:, 1]))


def same_thing_probability(
    apart: Numbers, whole: Numbers, known: Numbers, learnt: RecognitionModel
) -> Floats:
    """Return (N,) probabilities that two things are pieces of one; arguments as for `pair_features`."""
    return learnt.joining.probability(pair_features(apart, whole, known, learnt))


def pair_features(apart: Numbers, whole: Numbers, known: Numbers, learnt: RecognitionModel) -> Floats:
    """Return features (N, F) from leaf probabilities of two things (N, 2, K) and of both as one (N, K).

    `known`: (N, 16), see `describe_pair`. The order of the two does not matter: the more certain one comes
    first.
    """
    things = nameable(learnt)
    order = np.argsort(-apart[..., things].max(axis=2), axis=1, kind="stable")[..., None]
    chances = np.concatenate([np.take_along_axis(apart, order, axis=1), whole[:, None]], axis=1)
    log_counts = np.take_along_axis(known[:, :2, None], order, axis=1)[..., 0]
    log_sizes = known[:, 7:].reshape(-1, 3, 3)
    log_sizes = np.concatenate(
        [np.take_along_axis(log_sizes[:, :2], order, axis=1), log_sizes[:, 2:]], axis=1
    )
    named = np.where(things, chances, -1.0)
    leaf = named.argmax(axis=2)
    as_first = np.take_along_axis(chances[:, 1:], leaf[:, :1, None], axis=2)[..., 0]
    too_large = log_sizes - np.log(learnt.sizes_m)[leaf]
    unnamed = chances[..., [learnt.classes.index(CLUTTER), learnt.classes.index(UNKNOWN)]]
    return np.column_stack(
        [
            np.log(np.maximum(named.max(axis=2), _LEAST)),
            np.log(np.maximum(as_first, _LEAST)),
            unnamed.reshape(len(unnamed), -1),
            log_counts,
            known[:, 2:7],
            np.maximum(too_large, 0.0).max(axis=2),
            np.minimum(too_large, 0.0).min(axis=2),
        ]
    ).astype(np.float32)


def nameable(learnt: RecognitionModel) -> NDArray[np.bool_]:
    """Return (K,) which leaves are classes of things."""
    return np.array([name not in (UNKNOWN, CLUTTER) for name in learnt.classes])


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
