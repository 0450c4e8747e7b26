"""Labels of an external detector as evidence in addition to our own votes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from semmap.nodes.perception_node.input.masks import Masks
from semmap.nodes.perception_node.recognition.recognition_model import CLUTTER, UNKNOWN, RecognitionModel
from semmap.nodes.perception_node.recognition.vote import choose_class
from semmap.nodes.perception_node.views.boxes import Numbers
from semmap.nodes.perception_node.views.merged_thing import Thing
from semmap.schemas.entities import ClassInfo

_SUREST = 0.98
_LEAST = 1e-4
"""Minimum vote for each class, and votes count half: on unknown things they are overconfident."""
_LONGEST = 100
"""Number of characters of a label that are kept."""
_STRONG = 0.7
"""From this probability on, our own votes may be more specific than a detector's label."""

_COMMON = {
    "backpack": "Backpack",
    "cell phone": "Cellphone",
    "coffee mug": "Cup",
    "computer keyboard": "Keyboard",
    "dining table": "Dining_Table",
    "garbage can": "Bin",
    "handbag": "Bag",
    "mug": "Cup",
    "plant": "Plant",
    "potted plant": "Plant",
    "refrigerator": "Fridge",
    "remote": "Remote_Control",
    "rucksack": "Backpack",
    "sofa": "Couch",
    "soda can": "Can",
    "sports ball": "Ball",
    "teddy bear": "Toy",
    "tin can": "Can",
    "trash can": "Bin",
    "tv": "Television",
    "wine bottle": "Bottle",
    "wine glass": "Glass",
}
"""Labels of COCO and LVIS that are not the name of their class."""


class LabelMap:
    """Maps labels of a detector to classes. A name or a label of a class in the TBox needs no entry."""

    def __init__(
        self,
        learnt: RecognitionModel,
        classes: Mapping[str, str] | None = None,
        tbox: Iterable[ClassInfo] = (),
    ) -> None:
        """Build the map. `classes` maps other labels; case, spaces, `_` and `-` are ignored.

        `tbox`: the classes of the map. Without them, those known at training are used.
        """
        own = [row for row in tbox if row.spatial]
        self._ancestors = {**learnt.ancestors, **{row.name: row.ancestors for row in own}}
        learnt_names = {name for name in (*learnt.classes, *learnt.ancestors) if name}
        known = {_plain(word): name for word, name in _COMMON.items() if name in learnt_names}
        known |= {_plain(name): name for name in sorted(learnt_names)}
        known |= {_plain(word): row.name for row in own for word in (*row.also, *row.labels.values())}
        self._known = known | {_plain(row.name): row.name for row in own}
        self._learnt_names = learnt_names
        self._classes = {_plain(label): name for label, name in (classes or {}).items()}

    def class_of(self, label: str) -> str | None:
        """Return the class of a label, or None if it is unknown."""
        return self._classes.get(_plain(label)) or self._known.get(_plain(label))

    def ancestors_of(self, class_: str) -> tuple[str, ...]:
        """Return the superclasses of a class; empty for an unknown one."""
        return self._ancestors.get(class_, ())

    def is_learnt(self, class_: str) -> bool:
        """Return whether the classifiers know a class of this name, or leaves of it."""
        return class_ in self._learnt_names

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
            leaves = _evidence_for(labels.class_of(label.label), learnt, labels)
            if leaves.any():
                score = min(label.score, _SUREST)
                weight = np.where(leaves, score / leaves.sum(), (1.0 - score) / (~leaves).sum())
                chances[n] = np.sqrt(np.maximum(chances[n], _LEAST)) * weight
                chances[n, clutter] = 0.0
                chances[n] /= chances[n].sum()
    return chances


def as_general(
    thing: Thing, class_: str, own: Mapping[str, float], learnt: RecognitionModel, labels: LabelMap
) -> str:
    """Return a class, or the detected superclass of it if our own votes for the subclass are not strong.

    `own`: the probabilities of the leaves without the detector. A label of a general class is as specific as
    the detector was sure, and says nothing of its subclasses.
    """
    general = {
        word
        for segment in thing.segments
        if segment.detector_label
        and (word := labels.class_of(segment.detector_label.label)) is not None
        and word != UNKNOWN
        and word in learnt.ancestors.get(class_, ())
    }
    if not general:
        return class_
    named = min(general, key=lambda word: (_leaves_of(word, learnt).sum(), word))
    strong, _ = choose_class(own, learnt.ancestors, _STRONG)
    return strong if named in learnt.ancestors.get(strong, ()) else named


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


def _evidence_for(
    class_: str | None, learnt: RecognitionModel, labels: LabelMap
) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    """Return (K,) the leaves of a class or, if it was not learnt, of its nearest learnt superclass."""
    leaves = _leaves_of(class_, learnt)
    if leaves.any() or class_ is None:
        return leaves
    above = [_leaves_of(name, learnt) for name in labels.ancestors_of(class_) if name != UNKNOWN]
    return min((one for one in above if one.any()), key=np.count_nonzero, default=leaves)


def _leaves_of(class_: str | None, learnt: RecognitionModel) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    """Return (K,) the leaves of a class."""
    return np.array([class_ in (leaf, *learnt.ancestors.get(leaf, ())) for leaf in learnt.classes])


def _plain(label: str) -> str:
    return "".join(c for c in label.casefold() if c.isalnum())
