"""Changes of the map: what is asked of the knowledge base, and what it answers."""

from __future__ import annotations

from msgspec import Struct

from schemas.entities import CommandId, Entity, Probability, Source
from schemas.explanations import Term, Triple


class Transaction(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """One atomic change with its preconditions.

    It is refused with `PreconditionFailed` unless every triple of `require` is asserted, and with
    `NameTaken` unless no triple has a term of `vacant` as its subject. `id` is the command's: the same id
    a second time changes nothing and is answered with the first commit.
    """

    id: CommandId
    source: Source
    agent: str = ""
    reason: str = ""
    confidence: Probability | None = None
    require: tuple[Triple, ...] = ()
    vacant: tuple[Term, ...] = ()
    retract: tuple[Triple, ...] = ()
    insert: tuple[Triple, ...] = ()


class Departed(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """An entity that left the map, with the classes it had."""

    name: str
    types: tuple[str, ...]


class Commit(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """One atomic, checked, durable change. `changed` and `removed` are the entities that it touched."""

    seq: int
    stamp_ns: int
    id: str
    source: Source
    agent: str = ""
    reason: str = ""
    confidence: Probability | None = None
    retracted: tuple[Triple, ...] = ()
    inserted: tuple[Triple, ...] = ()
    changed: tuple[Entity, ...] = ()
    removed: tuple[Departed, ...] = ()


class Snapshot(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """All entities as they are after commit `seq`."""

    seq: int
    entities: tuple[Entity, ...]


class Star(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The triples about one entity, after commit `seq`."""

    seq: int
    name: str
    iri: Term
    own: tuple[Triple, ...]
    """Its own: they go when it goes. A reference that another entity uses too is not among them."""
    incoming: tuple[Triple, ...]
    """What other individuals say of it."""
    coordinates: Term | None
    size: Term | None
    preferred: tuple[Term, ...]
    alternatives: tuple[Term, ...]
