"""Differences between two states of the map, by entity."""

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
    """The difference of one entity between two states, with the entity in both; None where it does not exist.

    An entity is `moved` if only its position or orientation differs.
    """

    mark: Mark
    text: str
    was: Entity | None
    now: Entity | None


def find_differences(was: Mapping[str, Entity], now: Mapping[str, Entity]) -> dict[str, Difference]:
    """Return the entities that were added, removed, moved or changed, by name."""
    found = {
        name: difference
        for name, entity in now.items()
        if (before := was.get(name)) != entity and (difference := compare(before, entity)) is not None
    }
    for name in sorted(was.keys() - now.keys()):
        found[name] = Difference(mark="removed", text="removed", was=was[name], now=None)
    return found


def compare(was: Entity | None, now: Entity) -> Difference | None:
    """Return the difference of an entity; None without one.

    An unknown size equals any size, because replies about the past contain default sizes.
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


def format_counts(found: Mapping[str, Difference]) -> str:
    """Return the number of differences of each kind: `2 added, 1 moved`."""
    number = {mark: sum(d.mark == mark for d in found.values()) for mark in MARKS}
    return ", ".join(f"{count} {mark}" for mark, count in number.items() if count) or "no differences"


def find_changed_bodies(was: Scene | None, now: Scene | None) -> frozenset[str] | None:
    """Return the names of bodies that were added, removed, or changed their appearance; poses do not count.

    The result is None, for all bodies, if one of the scenes does not exist.
    """
    if was is None or now is None:
        return None if was is not now else frozenset()
    before, after = _appearances(was), _appearances(now)
    return frozenset(name for name in before.keys() | after.keys() if before.get(name) != after.get(name))


def _appearances(scene: Scene) -> dict[str, tuple[object, ...]]:
    return {body.name: _appearance(body) for body in scene.bodies}


def _appearance(body: Body) -> tuple[object, ...]:
    return (body.model, body.size_m, body.ghost, body.entity)
