"""Changes of the map: what is asked of the knowledge base, and what it answers."""

from __future__ import annotations

from msgspec import Struct

from schemas.entities import (
    Angle,
    CommandId,
    Entity,
    Probability,
    Provenance,
    Quaternion,
    Size,
    Source,
    Vector,
)
from schemas.explanations import Term, Triple


class Placed(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Where an entity is from now on, and how big; what is not given stays as it is."""

    name: str
    at: Vector | None = None
    yaw: Angle | None = None
    orientation: Quaternion | None = None
    size: Size | None = None


class Transaction(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """One atomic change with its preconditions.

    It is refused with `PreconditionFailed` unless every triple of `require` is asserted, and with
    `NameTaken` unless no triple has a term of `vacant` as its subject. `id` is the command's: the same id
    a second time changes nothing and is answered with the first commit.

    `placed` are entities (`UnknownName` without one) that are somewhere else now; the knowledge base itself
    says so in triples, because it knows their coordinates.

    `verb` is that of the command which a client sent; empty for what the system does by itself (the seed,
    settling). `undoes` are the commits that it takes back.
    """

    id: CommandId
    source: Source
    agent: str = ""
    verb: str = ""
    reason: str = ""
    confidence: Probability | None = None
    undoes: tuple[int, ...] = ()
    placed: tuple[Placed, ...] = ()
    require: tuple[Triple, ...] = ()
    vacant: tuple[Term, ...] = ()
    retract: tuple[Triple, ...] = ()
    insert: tuple[Triple, ...] = ()


class Departed(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """An entity that left the map, with the classes it had."""

    name: str
    types: tuple[str, ...]


class Commit(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """One atomic, checked, durable change. `changed` and `removed` are the entities that it touched.

    `verb` and `undoes` are those of the transaction. `tbox`: it replaced the TBox, so the classes are others.
    """

    seq: int
    stamp_ns: int
    id: str
    source: Source
    agent: str = ""
    verb: str = ""
    reason: str = ""
    confidence: Probability | None = None
    undoes: tuple[int, ...] = ()
    tbox: bool = False
    retracted: tuple[Triple, ...] = ()
    inserted: tuple[Triple, ...] = ()
    changed: tuple[Entity, ...] = ()
    removed: tuple[Departed, ...] = ()

    @property
    def provenance(self) -> Provenance:
        """That of what it changed."""
        return Provenance(
            commit=self.seq,
            stamp_ns=self.stamp_ns,
            source=self.source,
            agent=self.agent,
            reason=self.reason,
            confidence=self.confidence,
        )

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the entities that it touched."""
        return tuple(dict.fromkeys([*(e.name for e in self.changed), *(gone.name for gone in self.removed)]))


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
