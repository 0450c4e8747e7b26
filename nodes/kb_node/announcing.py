"""What the knowledge base tells everybody: its commits, and the entities under their classes' keys."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from msgspec import structs

from semmap.nodes import bus
from semmap.nodes.kb_node.beliefs import UNCHANGED, Believed
from semmap.schemas import codec, keys
from semmap.schemas.commits import Commit, Effects, PlaceChanges, abridged
from semmap.schemas.entities import Entity
from semmap.schemas.relations import Described


class Announcer:
    """Publishes each commit, and under each of its classes an entity or, where it is no more, a delete."""

    def __init__(
        self,
        session: bus.Session,
        entities: Iterable[Entity],
        described: Callable[[str], Described | None],
    ) -> None:
        """`entities` are those that are in the map already; `described(name)` is one with its whereabouts."""
        self._session = session
        self._described = described
        self._commits = bus.publisher(session, keys.COMMIT)
        self._untold = bus.publisher(session, keys.COMMIT_EFFECTS)
        self._entities_are_watched = bus.watched(session, keys.ENTITY)
        self._types = {entity.name: entity.types for entity in entities}

    def announce(self, commit: Commit, believed: Believed = UNCHANGED, *, told: bool) -> None:
        """Tell of the commit, abridged if it is large; of its entities only if somebody follows them.

        `believed` is how what holds of places changed with it. If the coordinator is `told` of it by the
        reply, it is not told of it here.
        """
        passed_on = abridged(_with_places(commit, believed))
        payload = codec.encode(passed_on)
        if len(payload) > bus.PUBLISHED:
            passed_on = abridged(commit, always=True)
            payload = codec.encode(passed_on)
        if not told:
            effects = Effects.of(passed_on)
            self._untold.put(codec.encode(effects), encoding=codec.encoding_of(effects))
        self._commits.put(payload, encoding=codec.encoding_of(passed_on))
        if self._entities_are_watched():
            for gone in commit.removed:
                self._delete(gone.name, self._types.get(gone.name, gone.types))
            for name in dict.fromkeys((*(e.name for e in commit.changed), *believed.subjects)):
                if (described := self._described(name)) is not None:
                    self._put(described)
        for gone in commit.removed:
            self._types.pop(gone.name, None)
        for entity in commit.changed:
            self._types[entity.name] = entity.types

    def _put(self, entity: Described) -> None:
        lost = set(self._types.get(entity.name, ())).difference(entity.types)
        self._delete(entity.name, sorted(lost))
        payload, encoding = codec.encode(entity), codec.encoding_of(entity)
        if len(payload) > bus.PUBLISHED:
            return  # whoever wants to know it asks
        for class_name in entity.types:
            self._session.put(keys.entity_key(class_name, entity.name), payload, encoding=encoding)

    def _delete(self, name: str, class_names: Iterable[str]) -> None:
        for class_name in class_names:
            self._session.delete(keys.entity_key(class_name, name))


def _with_places(commit: Commit, believed: Believed) -> Commit:
    """The commit as it is published: with what changed of what holds of places."""
    if commit.tbox or not any(believed):
        return commit
    places = PlaceChanges(
        came=believed.come, went=believed.gone, denied=believed.aside, undenied=believed.back
    )
    return structs.replace(commit, places=places)
