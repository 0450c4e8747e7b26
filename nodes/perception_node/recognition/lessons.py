"""What people have shown: things that are recognised by how they looked, beside the votes.

Each lesson is a leaf of its own below its class: its things may look like nothing else of that class, and
have a size of their own. Nothing is trained anew.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from semmap.nodes.perception_node.recognition.likeness import Likeness, views_of
from semmap.nodes.perception_node.recognition.shipped_votes import Learnt
from semmap.nodes.perception_node.views.boxes import Numbers
from semmap.schemas.entities import Size

_SUREST = 0.999
_LEAST = 1e-3
"""What is less likely the same thing is not: many lessons are not to wear the votes down."""


@dataclass(frozen=True)
class Lesson:
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
class Shown:
    """Tells whether a thing is one of those that were shown."""

    lessons: tuple[Lesson, ...]
    likeness: Likeness

    def mixed(self, features: Sequence[Numbers], chances: Numbers) -> Numbers:
        """(N, K + L) probabilities: of the leaves that were voted for (N, K), then of L lessons.

        Whether a thing is that of a lesson is told apart from the votes; what is left is theirs.
        """
        seen = views_of(features)
        like = np.column_stack([self._like(seen, lesson) for lesson in self.lessons])
        odds = like / (1.0 - like)
        rest = 1.0 / (1.0 + odds.sum(axis=1, keepdims=True))
        return np.concatenate([chances * rest, odds * rest], axis=1)

    def _like(self, seen: Numbers, lesson: Lesson) -> Numbers:
        """(N,) how likely each is the same as in the view of the lesson that it is most like."""
        best = self.likeness(lesson.views, seen).max(axis=0)
        return np.where(best < _LEAST, 0.0, np.minimum(best, _SUREST))


def taught(learnt: Learnt, lessons: Sequence[Lesson], likeness: Likeness) -> Learnt:
    """What was `learnt` by training, and these lessons beside it; without any it is as it was."""
    if not lessons:
        return learnt
    sideways = [lesson.class_ in learnt.classes and _is_sideways(learnt, lesson.class_) for lesson in lessons]
    return replace(
        learnt,
        classes=(*learnt.classes, *(lesson.leaf for lesson in lessons)),
        ancestors={
            **{lesson.class_: lesson.ancestors for lesson in lessons},
            **learnt.ancestors,
            **{lesson.leaf: (lesson.class_, *lesson.ancestors) for lesson in lessons},
        },
        sizes_m=np.concatenate([learnt.sizes_m, [lesson.size_m for lesson in lessons]]),
        sideways=np.concatenate([learnt.sideways, sideways]),
        shown=Shown(tuple(lessons), likeness),
    )


def _is_sideways(learnt: Learnt, class_: str) -> bool:
    return bool(learnt.sideways[learnt.classes.index(class_)])
