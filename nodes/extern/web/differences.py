"""How two states of the map differ, entity by entity. Pure."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final, Literal

from msgspec import Struct

from semmap.schemas import changes
from semmap.schemas.changes import Change
from semmap.schemas.entities import Entity
from semmap.schemas.scenes import Body, Scene

Mark = Literal["added", "removed", "moved", "changed"]
MARKS: Final[tuple[Mark, ...]] = ("added", "removed", "moved", "changed")


class Difference(Struct, frozen=True, kw_only=True):
    """How an entity differs between two states: in words, and as it was and is; None where it is not there.

    `moved` is one whose position or orientation alone is another.
    """

    mark: Mark
    text: str
    was: Entity | None
    now: Entity | None


def differences(was: Mapping[str, Entity], now: Mapping[str, Entity]) -> dict[str, Difference]:
    """What is otherwise than it was, by name: what came, went, moved or changed."""
    found = {
        name: difference
        for name, entity in now.items()
        if (before := was.get(name)) != entity and (difference := between(before, entity)) is not None
    }
    for name in sorted(was.keys() - now.keys()):
        found[name] = Difference(mark="removed", text="removed", was=was[name], now=None)
    return found


def between(was: Entity | None, now: Entity) -> Difference | None:
    """How an entity differs from what it was; None where it does not.

    Replies of the past fill in sizes that the map does not state, so one that is not known counts as equal.
    """
    if was is None:
        return Difference(mark="added", text=f"added as {now.class_}", was=None, now=now)
    found = [change for change in changes.between(was, now) if not _is_of_unknown_size(change)]
    if not found:
        return None
    mark: Mark = "moved" if all(change.kind == "pose" for change in found) else "changed"
    return Difference(mark=mark, text=changes.in_words(found), was=was, now=now)


def _is_of_unknown_size(change: Change) -> bool:
    return change.kind == "size" and (change.was is None or change.now is None)


def counted(found: Mapping[str, Difference]) -> str:
    """`2 added, 1 moved`; how many there are of each kind."""
    number = {mark: sum(d.mark == mark for d in found.values()) for mark in MARKS}
    return ", ".join(f"{count} {mark}" for mark, count in number.items() if count) or "no differences"


def bodies_otherwise(was: Scene | None, now: Scene | None) -> frozenset[str] | None:
    """The names of bodies that came, went, or look otherwise than before, wherever they are.

    None, for all things, where there was no scene or is none.
    """
    if was is None or now is None:
        return None if was is not now else frozenset()
    before, after = _looks(was), _looks(now)
    return frozenset(name for name in before.keys() | after.keys() if before.get(name) != after.get(name))


def _looks(scene: Scene) -> dict[str, tuple[object, ...]]:
    return {body.name: _look(body) for body in scene.bodies}


def _look(body: Body) -> tuple[object, ...]:
    return (body.model, body.size_m, body.ghost, body.entity)
