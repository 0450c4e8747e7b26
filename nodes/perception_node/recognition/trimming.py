"""Classifies uncertain things again without their outer cells, which may belong to neighbours."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from semmap.nodes.perception_node.recognition.features import features_of
from semmap.nodes.perception_node.recognition.recognition_model import CLUTTER, UNKNOWN, RecognitionModel
from semmap.nodes.perception_node.recognition.vote import leaf_probabilities
from semmap.nodes.perception_node.views.boxes import Numbers, best_yaw, box_around, in_frame
from semmap.nodes.perception_node.views.merged_thing import Thing

_DOUBTFUL = 0.6
_GAIN = 0.3
_OUTERMOST = 0.03
_LEFT = 0.6
"""A thing whose box shrinks below this share without few cells may include a piece of another thing."""

_FEWEST = 60


def reclassify_trimmed(things: Sequence[Thing], chances: Numbers, learnt: RecognitionModel) -> Numbers:
    """Return (N, K) leaf probabilities, those of the trimmed thing if it is recognised much better.

    A new thing must not become a known one by trimming, so the gain has to be large.
    """
    nameable = np.array([name not in (UNKNOWN, CLUTTER) for name in learnt.classes])
    known = chances[:, nameable].max(axis=1, initial=0.0)
    trimmed = {
        n: trim(thing)
        for n, thing in enumerate(things)
        if known[n] < _DOUBTFUL and not thing.carrier and len(thing.cells) > _FEWEST
    }
    rows = [n for n, part in trimmed.items() if part.box.size_m.prod() < _LEFT * things[n].box.size_m.prod()]
    if not rows:
        return chances
    again = leaf_probabilities(learnt, features_of([trimmed[n] for n in rows]))
    better = again[:, nameable].max(axis=1) > known[rows] + _GAIN
    chances = chances.copy()
    chances[np.array(rows)[better]] = again[better]
    return chances


def trim(thing: Thing) -> Thing:
    """Return a thing without its outermost cells along each axis of its box, except at the bottom."""
    turned = in_frame(thing.cells, thing.box.yaw_rad)
    low, high = np.quantile(turned, [_OUTERMOST, 1.0 - _OUTERMOST], axis=0)
    inner = (turned >= low)[:, :2].all(axis=1) & (turned <= high).all(axis=1)
    cells = thing.cells[inner]
    return replace(
        thing,
        cells=cells,
        colors=None if thing.colors is None else thing.colors[inner],
        box=box_around(cells, best_yaw(cells), float(thing.box.low[2])),
    )
