"""Command handlers for exemplars: `learn`, `learned` and `forget`, at `semmap/perception/<verb>`."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from semmap.nodes.perception_node.exemplar_store import ExemplarStore
from semmap.nodes.perception_node.exemplar_views import ExemplarView, exemplar_view_of
from semmap.nodes.perception_node.image_features.image_evidence import ThingImages
from semmap.nodes.perception_node.pipeline import FrameResult
from semmap.nodes.perception_node.recognition.recognition_model import RecognitionModel
from semmap.nodes.perception_node.recognition.similarity import WIDTH
from semmap.nodes.perception_node.tracking.class_hierarchy import ClassHierarchy
from semmap.nodes.perception_node.views.merged_thing import Thing
from semmap.nodes.runtime.loop import Node
from semmap.schemas import calls, errors, keys, wording
from semmap.schemas.commands import Forget, Learn, Learned
from semmap.schemas.exemplars import LessonTold, ShownView
from semmap.schemas.perception import Observation

_NOW_S = 3.0
"""Observations that are older are not current."""


class _Current(NamedTuple):
    """A thing, when it was seen (by the monotonic clock), and its images."""

    at_s: float
    thing: Thing
    images: ThingImages | None


class ExemplarCommands:
    """Handlers that learn exemplars from what cameras see now. Bound to the node's thread."""

    def __init__(
        self,
        node: Node,
        store: ExemplarStore,
        classes: Callable[[], ClassHierarchy],
        on_change: Callable[[RecognitionModel], None],
    ) -> None:
        """Register the handlers. `taught(learnt)` is called after each change of the model."""
        self._store = store
        self._classes = classes
        self._on_change = on_change
        self._seen: dict[str, _Current] = {}
        on_change(store.learnt)
        node.serve(
            keys.PERCEPTION,
            calls.by_verb(
                Learn.answered_by(self._learn),
                Learned.answered_by(lambda _: store.exemplars),
                Forget.answered_by(self._forget),
            ),
        )

    def see(self, found: FrameResult, observations: Sequence[Observation]) -> None:
        """Store the things of a frame by the entities that they were assigned to."""
        now = time.monotonic()
        self._seen = {name: current for name, current in self._seen.items() if now - current.at_s < _NOW_S}
        for n, (thing, seen) in enumerate(zip(found.things, observations, strict=False)):
            if seen.entity:
                images = None if found.images is None else found.images.select([n])
                self._seen[seen.entity] = _Current(now, thing, images)

    def _learn(self, command: Learn) -> LessonTold:
        if command.entity is not None:
            current = self._current(command.entity)
            views = [exemplar_view_of(current.thing, self._store.learnt, current.images)]
            shown = command.shown or f"entity {command.entity}"
        else:
            views, shown = [_view(one) for one in command.views], command.shown or "views"
        exemplar = self._store.add(command.class_, self._ancestors(command.class_), views, shown)
        self._on_change(self._store.learnt)
        return exemplar

    def _forget(self, command: Forget) -> LessonTold:
        exemplar = self._store.forget(command.number)
        self._on_change(self._store.learnt)
        return exemplar

    def _ancestors(self, class_: str) -> tuple[str, ...]:
        """Return a class's ancestors, most specific first, as of training or else from the current TBox."""
        if (known := self._store.learnt.ancestors.get(class_)) is not None:
            return known
        classes = self._classes()
        return tuple(sorted(classes.ancestors.get(class_, ()), key=lambda a: (-classes.depth(a), a)))

    def _current(self, name: str) -> _Current:
        now = time.monotonic()
        there = {entity: current for entity, current in self._seen.items() if now - current.at_s < _NOW_S}
        if name not in there:
            sees = (
                f"visible are: {wording.few(sorted(there), 5)}"
                if there
                else "no entity of the map is visible"
            )
            raise errors.Refused(f"{name} is not visible to perception; {sees}")
        if not there[name].thing.whole:
            raise errors.Refused(f"only a part of {name} is in view; point a camera at all of it")
        return there[name]


def view_message(view: ExemplarView) -> ShownView:
    """Return a view as a message."""
    features = np.concatenate([view.features, view.image])
    return ShownView(features=features.astype("<f4").tobytes(), size_m=view.size_m)


def _view(message: ShownView) -> ExemplarView:
    if len(message.features) % 4:
        raise errors.BadRequest("the features of a view must be 32-bit floats")
    features = np.frombuffer(message.features, "<f4").astype(float)
    return ExemplarView(features[:WIDTH], message.size_m, features[WIDTH:])
