"""Names that somebody else's detector gave: evidence beside our own votes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from semmap.nodes.perception_node.input.masks import Masks
from semmap.nodes.perception_node.recognition.recognition_model import CLUTTER, UNKNOWN, RecognitionModel
from semmap.nodes.perception_node.views.boxes import Numbers
from semmap.nodes.perception_node.views.merged_thing import Thing

_SUREST = 0.98
_LEAST = 1e-4
"""No vote of ours rules a class out, and all count half: of what they never saw they are far too sure."""


class LabelMap:
    """From a detector's labels to classes of ours; a label that is a class's own name needs no entry."""

    def __init__(self, learnt: RecognitionModel, classes: Mapping[str, str] | None = None) -> None:
        """`classes`: of labels that are called otherwise here; case, spaces, `_` and `-` do not matter."""
        self._known = {_plain(name): name for name in (*learnt.classes, *learnt.ancestors) if name}
        self._classes = {_plain(label): name for label, name in (classes or {}).items()}

    def class_of(self, label: str) -> str | None:
        """The class, or None for a label that nobody knows."""
        return self._classes.get(_plain(label)) or self._known.get(_plain(label))

    def is_learnt(self, class_: str) -> bool:
        """Whether our own votes know a class of exactly this name, or leaves of it."""
        return class_ in self._known.values()

    def unknown(self, masks: Iterable[Masks | None]) -> tuple[str, ...]:
        """LabelMap of these masks that nobody knows, sorted."""
        labels = {said.label for found in masks if found is not None for said in found.said if said}
        return tuple(sorted(label for label in labels if self.class_of(label) is None))


def with_detector_labels(
    chances: Numbers, things: Sequence[Thing], learnt: RecognitionModel, labels: LabelMap
) -> Numbers:
    """Our votes (N, K) together with what detectors said; what they masked is no clutter.

    A label with a score is evidence for the leaves of its class against all others, by Bayes: where the
    detector errs, it may have said anything.
    """
    chances = chances.copy()
    clutter, unknown = learnt.classes.index(CLUTTER), learnt.classes.index(UNKNOWN)
    for n, thing in enumerate(things):
        if not thing.masked:
            continue
        chances[n, unknown] += chances[n, clutter]
        chances[n, clutter] = 0.0
        for said in {segment.said for segment in thing.segments if segment.said}:
            leaves = _leaves_of(labels.class_of(said.label), learnt)
            if leaves.any():
                score = min(said.score, _SUREST)
                weight = np.where(leaves, score / leaves.sum(), (1.0 - score) / (~leaves).sum())
                chances[n] = np.sqrt(np.maximum(chances[n], _LEAST)) * weight
                chances[n, clutter] = 0.0
                chances[n] /= chances[n].sum()
    return chances


def detector_class(thing: Thing, learnt: RecognitionModel, labels: LabelMap) -> tuple[str, float] | None:
    """The class, never learnt here, that detectors are surest of; None where there is no such."""
    said = [
        (class_, segment.said.score)
        for segment in thing.segments
        if segment.said
        and (class_ := labels.class_of(segment.said.label)) is not None
        and not _leaves_of(class_, learnt).any()
    ]
    return max(said, key=lambda one: one[1], default=None)


def _leaves_of(class_: str | None, learnt: RecognitionModel) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    """(K,) the leaves that are of a class."""
    return np.array([class_ in (leaf, *learnt.ancestors.get(leaf, ())) for leaf in learnt.classes])


def _plain(label: str) -> str:
    return "".join(c for c in label.casefold() if c.isalnum())
