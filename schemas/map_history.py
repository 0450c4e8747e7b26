"""The history of a map: changes between two commits, and the intervals in which relations held."""

from __future__ import annotations

from typing import Literal

from msgspec import Struct

from semmap.schemas.changes import Change
from semmap.schemas.entities import Vector

KeptRelation = Literal["isOn", "isInside", "isLocatedIn", "isAttachedTo"]
"""The spatial relations that are known for every commit."""
TimedRelation = KeptRelation | Literal["isNear"]
"""The spatial relations whose times are computed on request."""


class Related(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A computed relation that holds only after the later commit (`came`) or only after the earlier one."""

    subject: str
    relation: KeptRelation
    object: str
    came: bool
    text: str
    """A text without the subject: `is no longer on table1`."""


class Difference(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The changes between the map after commit `first` and after commit `last`, sorted by name.

    The time stamps are those of the two commits, in nanoseconds since 1970.
    """

    first: int
    last: int
    first_ns: int
    last_ns: int
    changes: tuple[Change, ...]
    relations: tuple[Related, ...]


class Spell(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """An interval in which a relation held: from one commit until just before another, or until now.

    `since` is 0 if it held before the history begins. Time stamps are nanoseconds since 1970.
    """

    since: int
    since_ns: int
    until: int | None = None
    until_ns: int | None = None


class Spells(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The intervals in which a spatial relation or a property's value held, in order.

    `object` is an entity, or the value of the property as text.
    """

    subject: str
    relation: str
    object: str
    spells: tuple[Spell, ...]
    total_s: float
    """The total duration [s], by the time stamps of the commits."""
    text: str
    visits: tuple[Visit, ...] = ()
    """When a tracked entity was in the place by its live poses, if the relation is `isLocatedIn`."""


class Visit(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A time in which a live entity was in a place; `until_ns` is None while it is there.

    `left` is False if its live poses ended in the place, so that it may have been there for longer. Time
    stamps are nanoseconds since 1970.
    """

    name: str
    place: str
    since_ns: int
    until_ns: int | None = None
    left: bool = True


class TrailPoint(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The position [m] of a live entity at a time [ns since 1970], and the places that contain it.

    It holds until the next one of the same entity, at most until `until_ns` if that is given.
    """

    name: str
    ns: int
    at: Vector
    places: tuple[str, ...] = ()
    until_ns: int | None = None


class Trail(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The recorded live poses of entities: the places that they entered and left, and their tracks.

    `kept_since_ns` is the time from which on trails are stored. `omitted` visits and points are left out.
    """

    names: tuple[str, ...]
    visits: tuple[Visit, ...]
    track: tuple[TrailPoint, ...]
    kept_since_ns: int
    omitted_visits: int = 0
    omitted_points: int = 0
    text: str
