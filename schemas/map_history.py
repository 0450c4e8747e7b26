"""What happened to a map: what changed between two commits, and when something was where."""

from __future__ import annotations

from typing import Literal

from msgspec import Struct

from semmap.schemas.changes import Change

KeptRelation = Literal["isOn", "isInside", "isLocatedIn", "isAttachedTo"]
"""Spatial relations that are known of every commit."""


class Related(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A relation, as measured, that holds after the later commit only (`came`), or after the earlier only."""

    subject: str
    relation: KeptRelation
    object: str
    came: bool
    text: str
    """In words, without the subject: `is no longer on table1`."""


class Difference(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What changed between the map after commit `first` and the map after commit `last`, ordered by name.

    Stamps are those of the two commits, in nanoseconds since 1970.
    """

    first: int
    last: int
    first_ns: int
    last_ns: int
    changes: tuple[Change, ...]
    relations: tuple[Related, ...]


class Spell(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A time during which a relation held: from one commit until just before another, or until now.

    `since` is 0 where it held before the history begins. Stamps are nanoseconds since 1970.
    """

    since: int
    since_ns: int
    until: int | None = None
    until_ns: int | None = None


class Spells(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """When one thing was on, inside, in or attached to another, as measured: in order, without overlap."""

    subject: str
    relation: KeptRelation
    object: str
    spells: tuple[Spell, ...]
    total_s: float
    """How long in all [s], by the stamps of the commits."""
    text: str
