"""What people have shown: things that are recognised by how they looked, beside the votes.

Each exemplar is a leaf of its own below its class: its things may look like nothing else of that class, and
have a size of their own. Nothing is trained anew.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from semmap.nodes.perception_node.recognition.recognition_model import RecognitionModel
from semmap.nodes.perception_node.recognition.similarity import Similarity, views_of
from semmap.nodes.perception_node.views.boxes import Numbers
from semmap.schemas.entities import Size

_SUREST = 0.999
_LEAST = 1e-3
"""What is less likely the same thing is not: many exemplars are not to wear the votes down."""


@dataclass(frozen=True)
class Exemplar:
    """Views of one thing, or of several that look alike, and of which class they are.

    `number`: by which it is forgotten. `ancestors`: what the TBox has above the class. `views`: (N, WIDTH),
    see `likeness`. `size_m`: long side, short side and height. `shown`: what was shown, in words.
    """

    number: int
    class_: str
    ancestors: tuple[str, ...]
    views: Numbers
    size_m: Size
    shown: str
    stamp_ns: int

    @property
    def leaf(self) -> str:
        """Its name among the leaves of the vote; no class is called so."""
        return f"{self.class_} #{self.number}"


@dataclass(frozen=True)
class ExemplarMatcher:
    """Tells whether a thing is one of those that were shown."""

    exemplars: tuple[Exemplar, ...]
    similarity: Similarity

    def add_probabilities(self, features: Sequence[Numbers], chances: Numbers) -> Numbers:
        """(N, K + L) probabilities: of the leaves that were voted for (N, K), then of L exemplars.

        Whether a thing is that of a exemplar is told apart from the votes; what is left is theirs.
        """
        seen = views_of(features)
        like = np.column_stack([self._like(seen, exemplar) for exemplar in self.exemplars])
        odds = like / (1.0 - like)
        rest = 1.0 / (1.0 + odds.sum(axis=1, keepdims=True))
        return np.concatenate([chances * rest, odds * rest], axis=1)

    def _like(self, seen: Numbers, exemplar: Exemplar) -> Numbers:
        """(N,) how likely each is the same as in the view of the exemplar that it is most like."""
        best = self.similarity(exemplar.views, seen).max(axis=0)
        return np.where(best < _LEAST, 0.0, np.minimum(best, _SUREST))


def with_exemplars(
    learnt: RecognitionModel, exemplars: Sequence[Exemplar], similarity: Similarity
) -> RecognitionModel:
    """What was `learnt` by training, and these exemplars beside it; without any it is as it was."""
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
