"""Exemplars: things that were shown with `semmap learn`, recognised by their similarity.

Each exemplar is a leaf below its class, since it may look unlike other things of that class and have another
size. No classifier is retrained.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from semmap.nodes.perception_node.image_features.efficientnet import FEATURES
from semmap.nodes.perception_node.recognition.recognition_model import RecognitionModel
from semmap.nodes.perception_node.recognition.similarity import Similarity, views_of
from semmap.nodes.perception_node.views.boxes import Numbers
from semmap.schemas.entities import Size

_SUREST = 0.999
_LEAST = 1e-3
"""Smaller similarities count as 0, so that many exemplars do not suppress the votes."""
_LEAST_WITH_IMAGE = 0.02
"""The same for similarities that include those of images."""
_SHAPE, _IMAGE, _BIAS = 0.35, 15.0, -6.7
"""The logarithm of the odds that a thing is an exemplar is a weighted sum of that by shape and colours and of
the cosine of the images. The weights maximise the likelihood of real frames of 31 things (0.31 to 0.37, 14 to
17 in four folds), and the bias gives as few false names as before if several things are shown."""


@dataclass(frozen=True)
class Exemplar:
    """Views of one thing, or of several that look alike, with their class.

    `number` identifies it. `ancestors`: the superclasses in the TBox. `views`: (N, WIDTH), see `similarity`.
    `size_m`: long side, short side and height. `shown`: a description of the source. `images`: (N, FEATURES)
    the features of the images of the views, zeros for a view without.
    """

    number: int
    class_: str
    ancestors: tuple[str, ...]
    views: Numbers
    size_m: Size
    shown: str
    stamp_ns: int
    images: Numbers = field(default_factory=lambda: np.zeros((0, FEATURES)))

    @property
    def leaf(self) -> str:
        """Return its name among the leaves of the vote, which differs from all class names."""
        return f"{self.class_} #{self.number}"


@dataclass(frozen=True)
class ExemplarMatcher:
    """Estimates whether a thing is one of the exemplars."""

    exemplars: tuple[Exemplar, ...]
    similarity: Similarity

    def add_probabilities(self, features: Sequence[Numbers], chances: Numbers) -> Numbers:
        """Return (N, K + L) probabilities of K leaves and L exemplars, given those of the leaves (N, K).

        The probability of an exemplar does not depend on the votes, which share the remainder.
        """
        seen = views_of(features)
        like = np.column_stack([self._like(seen, exemplar) for exemplar in self.exemplars])
        odds = like / (1.0 - like)
        rest = 1.0 / (1.0 + odds.sum(axis=1, keepdims=True))
        return np.concatenate([chances * rest, odds * rest], axis=1)

    def with_images(self, chances: Numbers, similarities: Callable[[Numbers], Numbers]) -> Numbers:
        """Return probabilities (N, K + L) in which exemplars with images are compared by these, too.

        `similarities(images)`: (V, N) cosines of stored images and those of the things, NaN where unknown.
        """
        if not any(exemplar.images.any() for exemplar in self.exemplars):
            return chances
        votes, shown = np.split(chances, [-len(self.exemplars)], axis=1)
        rest = votes.sum(axis=1, keepdims=True)
        odds = shown / rest
        ends = np.cumsum([len(exemplar.images) for exemplar in self.exemplars])[:-1]
        cosines = np.split(similarities(np.concatenate([e.images for e in self.exemplars])), ends)
        alike = np.column_stack([np.fmax.reduce(each, axis=0, initial=np.nan) for each in cosines])
        together = _SHAPE * np.log(np.clip(odds, _LEAST, 1.0 / _LEAST)) + _IMAGE * alike + _BIAS
        like = 1.0 / (1.0 + np.exp(-together))
        like = np.where(like < _LEAST_WITH_IMAGE, 0.0, np.minimum(like, _SUREST))
        found = like / (1.0 - like)
        odds = np.where(np.isnan(alike), odds, found)
        left = 1.0 / (1.0 + odds.sum(axis=1, keepdims=True))
        return np.concatenate([votes / rest * left, odds * left], axis=1)

    def _like(self, seen: Numbers, exemplar: Exemplar) -> Numbers:
        """Return (N,) the similarity of each thing to the most similar view of an exemplar."""
        best = self.similarity(exemplar.views, seen).max(axis=0)
        return np.where(best < _LEAST, 0.0, np.minimum(best, _SUREST))


def with_exemplars(
    learnt: RecognitionModel, exemplars: Sequence[Exemplar], similarity: Similarity
) -> RecognitionModel:
    """Return the trained model extended by exemplars."""
    if not exemplars:
        return learnt
    sideways = [
        exemplar.class_ in learnt.classes and _is_sideways(learnt, exemplar.class_) for exemplar in exemplars
    ]
    return replace(
        learnt,
        classes=(*learnt.classes, *(exemplar.leaf for exemplar in exemplars)),
        ancestors={
            **{exemplar.class_: exemplar.ancestors for exemplar in exemplars},
            **learnt.ancestors,
            **{exemplar.leaf: (exemplar.class_, *exemplar.ancestors) for exemplar in exemplars},
        },
        sizes_m=np.concatenate([learnt.sizes_m, [exemplar.size_m for exemplar in exemplars]]),
        sideways=np.concatenate([learnt.sideways, sideways]),
        exemplars=ExemplarMatcher(tuple(exemplars), similarity),
    )


def _is_sideways(learnt: RecognitionModel, class_: str) -> bool:
    return bool(learnt.sideways[learnt.classes.index(class_)])
