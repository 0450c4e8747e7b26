"""What happened to a map: what is otherwise than it was, and when something was so."""

from __future__ import annotations

from typing import Literal

from msgspec import Struct

from schemas.changes import Change

KeptRelation = Literal["isOn", "isInside", "isLocatedIn", "isAttachedTo"]
"""Spatial relations that are known of every commit."""


class Related(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A relation that holds now and did not (`came`), or the other way round; as measured."""

    subject: str
    relation: KeptRelation
    object: str
    came: bool
    text: str
    """In words, without the subject: `is no longer on table1`."""


class Difference(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What is otherwise after commit `last` than it was after commit `first`, in the order of names."""

    first: int
    last: int
    changes: tuple[Change, ...]
    relations: tuple[Related, ...]


class Spell(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A time during which something was so: from a commit until before another, or until now.

    `since` is 0 where it was so before the history begins. Stamps are nanoseconds since 1970.
    """

    since: int
    since_ns: int
    until: int | None = None
    until_ns: int | None = None


class Spells(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """When it was so that one thing was on, in or at another, as measured: in order, without overlap."""

    subject: str
    relation: KeptRelation
    object: str
    spells: tuple[Spell, ...]
    total_s: float
    """How long all in all [s], by the stamps of the commits."""
    text: str
