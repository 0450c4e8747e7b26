"""Moments of the map, and its state then."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final, Protocol

from msgspec import Struct

from semmap.schemas.entities import Entity, Pose


class State(Protocol):
    """The map at a moment. `Live` is one, as it is now."""

    @property
    def entities(self) -> Mapping[str, Entity]:
        """By name."""

    @property
    def poses(self) -> Mapping[str, Pose]:
        """Where bodies stand, by name; of the past, where the map said that entities were."""

    @property
    def commit(self) -> int:
        """The last commit of it."""


class Moment(Struct, frozen=True):
    """Now, or after a commit of the past."""

    commit: int | None = None

    @property
    def is_now(self) -> bool:
        """Does it move on with the map?"""
        return self.commit is None


NOW: Final = Moment()


class Past(Struct, frozen=True, kw_only=True):
    """The map as it was after a commit."""

    entities: Mapping[str, Entity]
    poses: Mapping[str, Pose]
    commit: int
