"""Publishes commits, and entities under the keys of their classes."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from msgspec import structs

from semmap.nodes import bus
from semmap.nodes.kb_node.derived_facts import UNCHANGED, DerivedChanges
from semmap.schemas import codec, keys
from semmap.schemas.commits import Commit, Effects, PlaceChanges, abridged
from semmap.schemas.entities import Entity
from semmap.schemas.relations import Described


class CommitPublisher:
    """Publishes each commit, and each changed entity under its classes; a removed entity as a delete."""

    def __init__(
        self,
        session: bus.Session,
        entities: Iterable[Entity],
        describe: Callable[[str], Described | None],
    ) -> None:
        """Publish on `session`.

        `entities` are in the map already; `describe(name)` returns one with its location.
        """
        self._session = session
        self._describe = describe
        self._commits = bus.publisher(session, keys.COMMIT)
        self._effects = bus.publisher(session, keys.COMMIT_EFFECTS)
        self._entities_are_watched = bus.subscriber_check(session, keys.ENTITY)
        self._types = {entity.name: entity.types for entity in entities}

    def publish(self, commit: Commit, derived_changes: DerivedChanges = UNCHANGED, *, told: bool) -> None:
        """Publish the commit, abridged if it is large, and its entities if there are subscribers.

        `derived_changes` are the changes of computed facts. If the reply has `told` the coordinator about the
        commit, its effects are not published to it again.
        """
        passed_on = abridged(_with_places(commit, derived_changes))
        payload = codec.encode(passed_on)
        if len(payload) > bus.PUBLICATION_BYTES:
            passed_on = abridged(commit, always=True)
            payload = codec.encode(passed_on)
        if not told:
            effects = Effects.of(passed_on)
            self._effects.put(codec.encode(effects), encoding=codec.encoding_of(effects))
        self._commits.put(payload, encoding=codec.encoding_of(passed_on))
        if self._entities_are_watched():
            for departed in commit.removed:
                self._delete(departed.name, self._types.get(departed.name, departed.types))
            self._put_all(dict.fromkeys((*(e.name for e in commit.changed), *derived_changes.subjects)))
        for departed in commit.removed:
            self._types.pop(departed.name, None)
        for entity in commit.changed:
            self._types[entity.name] = entity.types

    def publish_entities(self, entities: Iterable[Entity]) -> None:
        """Publish entities whose computed facts have changed without a commit, if there are subscribers."""
        changed = {entity.name: entity.types for entity in entities}
        if self._entities_are_watched():
            self._put_all(changed)
        self._types.update(changed)

    def _put_all(self, names: Iterable[str]) -> None:
        for name in names:
            if (described := self._describe(name)) is not None:
                self._put(described)

    def _put(self, entity: Described) -> None:
        lost = set(self._types.get(entity.name, ())).difference(entity.types)
        self._delete(entity.name, sorted(lost))
        payload, encoding = codec.encode(entity), codec.encoding_of(entity)
        if len(payload) > bus.PUBLICATION_BYTES:
            return  # subscribers can request it with `get`
        for class_name in entity.types:
            self._session.put(keys.entity_key(class_name, entity.name), payload, encoding=encoding)

    def _delete(self, name: str, class_names: Iterable[str]) -> None:
        for class_name in class_names:
            self._session.delete(keys.entity_key(class_name, name))


def _with_places(commit: Commit, derived_changes: DerivedChanges) -> Commit:
    """Return the commit as published, with the changes of computed facts."""
    if commit.tbox or not any(derived_changes):
        return commit
    places = PlaceChanges(
        came=derived_changes.come,
        went=derived_changes.gone,
        denied=derived_changes.aside,
        undenied=derived_changes.back,
    )
    return structs.replace(commit, places=places)
