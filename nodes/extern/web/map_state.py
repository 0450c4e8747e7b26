"""The state of the map at a moment: now, or after a commit of the past."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final, Protocol

from msgspec import Struct

from semmap.schemas.entities import Entity, Pose


class MapState(Protocol):
    """The map at a moment; `Live` is the current one."""

    @property
    def entities(self) -> Mapping[str, Entity]:
        """The entities by name."""

    @property
    def poses(self) -> Mapping[str, Pose]:
        """The poses of the bodies by name; in the past, those of the entities in the map."""

    @property
    def commit(self) -> int:
        """The last commit of this state."""


class Moment(Struct, frozen=True):
    """The current moment, or the one after a commit."""

    commit: int | None = None

    @property
    def is_now(self) -> bool:
        """Whether it is the current moment."""
        return self.commit is None


NOW: Final = Moment()


class Snapshot(Struct, frozen=True, kw_only=True):
    """The map after a commit."""

    entities: Mapping[str, Entity]
    poses: Mapping[str, Pose]
    commit: int
