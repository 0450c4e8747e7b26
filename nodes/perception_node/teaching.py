"""Lessons on the wire: `learn`, `learned` and `forget`, asked at `semmap/perception/<verb>`."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

import numpy as np

from semmap.nodes.perception_node.lesson_book import LessonBook
from semmap.nodes.perception_node.recognition.shipped_votes import Learnt
from semmap.nodes.perception_node.showing import View, view_of
from semmap.nodes.perception_node.tracking.class_hierarchy import ClassHierarchy
from semmap.nodes.perception_node.views.merged_thing import Thing
from semmap.nodes.runtime.loop import Node
from semmap.schemas import calls, errors, keys, wording
from semmap.schemas.commands import Forget, Learn, Learned
from semmap.schemas.exemplars import LessonTold, ShownView
from semmap.schemas.perception import Observation

_NOW_S = 3.0
"""What was seen longer ago is not seen now."""


class Teaching:
    """What cameras see now, by its entity, can be shown to perception. Bound to the node's thread."""

    def __init__(
        self,
        node: Node,
        book: LessonBook,
        classes: Callable[[], ClassHierarchy],
        taught: Callable[[Learnt], None],
    ) -> None:
        """`taught(learnt)` is told of each change of what is known."""
        self._book = book
        self._classes = classes
        self._taught = taught
        self._seen: dict[str, tuple[float, Thing]] = {}
        taught(book.learnt)
        node.serve(
            keys.PERCEPTION,
            calls.by_verb(
                Learn.answered_by(self._learn),
                Learned.answered_by(lambda _: book.lessons),
                Forget.answered_by(self._forget),
            ),
        )

    def see(self, things: Sequence[Thing], observations: Sequence[Observation]) -> None:
        """What a look has shown: things, and for which entity each was taken."""
        now = time.monotonic()
        self._seen = {name: (at, thing) for name, (at, thing) in self._seen.items() if now - at < _NOW_S}
        for thing, seen in zip(things, observations, strict=False):
            if seen.entity:
                self._seen[seen.entity] = now, thing

    def _learn(self, command: Learn) -> LessonTold:
        if command.entity is not None:
            views = [view_of(self._now(command.entity), self._book.learnt)]
            shown = command.shown or f"entity {command.entity}"
        else:
            views, shown = [_view(one) for one in command.views], command.shown or "views"
        told = self._book.add(command.class_, self._above(command.class_), views, shown)
        self._taught(self._book.learnt)
        return told

    def _forget(self, command: Forget) -> LessonTold:
        told = self._book.forget(command.number)
        self._taught(self._book.learnt)
        return told

    def _above(self, class_: str) -> tuple[str, ...]:
        """What is above a class: as training had it, or as the TBox has it now, the most special first."""
        if (known := self._book.learnt.ancestors.get(class_)) is not None:
            return known
        classes = self._classes()
        return tuple(sorted(classes.ancestors.get(class_, ()), key=lambda a: (-classes.depth(a), a)))

    def _now(self, name: str) -> Thing:
        now = time.monotonic()
        there = {entity: thing for entity, (at, thing) in self._seen.items() if now - at < _NOW_S}
        if name not in there:
            sees = f"it sees {wording.few(sorted(there))}" if there else "it sees nothing that the map has"
            raise errors.Refused(f"perception does not see {name} now; {sees}")
        if not there[name].whole:
            raise errors.Refused(f"only a part of {name} is in a camera's picture now; turn the camera to it")
        return there[name]


def view_told(view: View) -> ShownView:
    """A view as it travels."""
    return ShownView(features=view.features.astype("<f4").tobytes(), size_m=view.size_m)


def _view(told: ShownView) -> View:
    if len(told.features) % 4:
        raise errors.BadRequest("the features of a view are 32-bit floats")
    return View(np.frombuffer(told.features, "<f4").astype(float), told.size_m)
