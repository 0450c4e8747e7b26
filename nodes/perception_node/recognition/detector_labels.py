"""Labels of an external detector as evidence in addition to our own votes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from semmap.nodes.perception_node.input.masks import Masks
from semmap.nodes.perception_node.recognition.recognition_model import CLUTTER, UNKNOWN, RecognitionModel
from semmap.nodes.perception_node.views.boxes import Numbers
from semmap.nodes.perception_node.views.merged_thing import Thing

_SUREST = 0.98
_LEAST = 1e-4
"""Minimum vote for each class, and votes count half: on unknown things they are overconfident."""
_LONGEST = 100
"""Number of characters of a label that are kept."""


class LabelMap:
    """Maps labels of a detector to our classes. A label that is a class name needs no entry."""

    def __init__(self, learnt: RecognitionModel, classes: Mapping[str, str] | None = None) -> None:
        """Build the map. `classes` maps other labels; case, spaces, `_` and `-` are ignored."""
        self._known = {_plain(name): name for name in (*learnt.classes, *learnt.ancestors) if name}
        self._classes = {_plain(label): name for label, name in (classes or {}).items()}

    def class_of(self, label: str) -> str | None:
        """Return the class of a label, or None if it is unknown."""
        return self._classes.get(_plain(label)) or self._known.get(_plain(label))

    def is_learnt(self, class_: str) -> bool:
        """Return whether the classifiers know a class of this name, or leaves of it."""
        return class_ in self._known.values()

    def unknown(self, masks: Iterable[Masks | None]) -> tuple[str, ...]:
        """Return the unknown labels of these masks, sorted."""
        labels = {
            found.label for mask in masks if mask is not None for found in mask.detector_labels if found
        }
        return tuple(sorted(label for label in labels if self.class_of(label) is None))


def with_detector_labels(
    chances: Numbers, things: Sequence[Thing], learnt: RecognitionModel, labels: LabelMap
) -> Numbers:
    """Combine our votes (N, K) with the labels of a detector; masked things are not clutter.

    A label with a score is evidence for the leaves of its class by Bayes' rule. If the detector is wrong, any
    label is equally likely.
    """
    chances = chances.copy()
    clutter, unknown = learnt.classes.index(CLUTTER), learnt.classes.index(UNKNOWN)
    for n, thing in enumerate(things):
        if not thing.masked:
            continue
        chances[n, unknown] += chances[n, clutter]
        chances[n, clutter] = 0.0
        for label in {segment.detector_label for segment in thing.segments if segment.detector_label}:
            leaves = _leaves_of(labels.class_of(label.label), learnt)
            if leaves.any():
                score = min(label.score, _SUREST)
                weight = np.where(leaves, score / leaves.sum(), (1.0 - score) / (~leaves).sum())
                chances[n] = np.sqrt(np.maximum(chances[n], _LEAST)) * weight
                chances[n, clutter] = 0.0
                chances[n] /= chances[n].sum()
    return chances


def detector_class(thing: Thing, learnt: RecognitionModel, labels: LabelMap) -> tuple[str, float] | None:
    """Return the best detected class that the classifiers do not know; None if there is none."""
    detected = [
        (class_, segment.detector_label.score)
        for segment in thing.segments
        if segment.detector_label
        and (class_ := labels.class_of(segment.detector_label.label)) is not None
        and not _leaves_of(class_, learnt).any()
    ]
    return max(detected, key=lambda one: one[1], default=None)


def unknown_label(thing: Thing, labels: LabelMap) -> str | None:
    """Return the label with the best score that matches no class, in one line.

    Returns "" if all its labels match classes, and None if there is no label. The number of a class, which a
    detector gives without its names, is not a label.
    """
    words = [
        segment.detector_label
        for segment in thing.segments
        if segment.detector_label and segment.detector_label.label.strip()
    ]
    unknown = [one for one in words if labels.class_of(one.label) is None]
    named = [one for one in unknown if not one.label.strip().isdecimal()]
    if not named:
        return "" if len(words) > len(unknown) else None
    return " ".join(max(named, key=lambda one: one.score).label.split())[:_LONGEST]


def _leaves_of(class_: str | None, learnt: RecognitionModel) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    """Return (K,) the leaves of a class."""
    return np.array([class_ in (leaf, *learnt.ancestors.get(leaf, ())) for leaf in learnt.classes])


def _plain(label: str) -> str:
    return "".join(c for c in label.casefold() if c.isalnum())
