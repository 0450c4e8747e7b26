"""Changes of the map: transactions, and the commits they result in."""

from __future__ import annotations

from operator import attrgetter
from typing import ClassVar, Final

from msgspec import Struct, structs

from semmap.schemas import errors
from semmap.schemas.calls import DOCUMENT, Call
from semmap.schemas.entities import (
    Angle,
    CommandId,
    Entity,
    Name,
    Pose,
    Probability,
    Provenance,
    Quaternion,
    Remark,
    Size,
    Source,
    Text,
    Tracked,
    Vector,
)
from semmap.schemas.explanations import Term, Triple
from semmap.schemas.scene_files import pose_of

_NAME: Final = attrgetter("name")


class Statement(Struct, frozen=True, gc=False, kw_only=True, forbid_unknown_fields=True, omit_defaults=True):
    """A property, by name or label, and values of it as they are written; none stands for all."""

    property: str
    values: tuple[str, ...] = ()


class NewEntity(Struct, frozen=True, gc=False, kw_only=True, forbid_unknown_fields=True, omit_defaults=True):
    """An entity to put into the map, under a name that must be free; positions and sizes in metres."""

    name: Name
    class_iri: str
    pose: Pose | None = None
    size: Size | None = None
    ref: Text | None = None
    alt: tuple[Text, ...] = ()
    affordances: tuple[str, ...] = ()
    """Individuals of the TBox, by their local names."""
    set: tuple[Statement, ...] = ()
    tracked: Tracked = ""


class Edit(Struct, frozen=True, gc=False, kw_only=True, forbid_unknown_fields=True, omit_defaults=True):
    """What an entity is to be from now on; omitted fields keep their values.

    `alt` replaces all alternative references. An empty `conflict` takes the present one back. `unset` goes
    before `set`, which replaces the value of a functional property and adds those of another. All of it is
    refused with `PreconditionFailed` unless the properties of `only_if` have one of these values now (no
    value, where none is given). With `carry`, what stands on the entity or is inside it moves with it as one
    rigid body, except what `leave` names. An empty `tracked` ends that.
    """

    name: str
    class_iri: str | None = None
    at: Vector | None = None
    yaw: Angle | None = None
    orientation: Quaternion | None = None
    size: Size | None = None
    ref: Text | None = None
    alt: tuple[Text, ...] | None = None
    conflict: Remark | None = None
    only_if: tuple[Statement, ...] = ()
    unset: tuple[Statement, ...] = ()
    set: tuple[Statement, ...] = ()
    carry: bool = False
    leave: tuple[str, ...] = ()
    tracked: Tracked | None = None

    @property
    def places(self) -> bool:
        """Does it say where the entity is?"""
        return not (self.at is None and self.yaw is None and self.orientation is None)

    def pose_after(self, before: Pose | None) -> Pose:
        """Where the entity is to be. Raises BadRequest for a pose that is none."""
        at = self.at or (before.position_m if before is not None else None)
        if at is None:
            raise errors.BadRequest(f"{self.name} has no position yet; give one with --at")
        return pose_of(at, self.yaw, self.orientation, before)


class Departed(Struct, frozen=True, gc=False, kw_only=True, forbid_unknown_fields=True):
    """An entity that left the map, with the classes it had."""

    name: str
    types: tuple[str, ...]


class Extent(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How many triples and entities a commit is about."""

    inserted: int
    retracted: int
    changed: int
    removed: int


class PlaceChanges(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, omit_defaults=True):
    """How a commit changed what holds of where things are, beyond the triples that it asserts and retracts.

    `came` and `went` are computed facts, which nobody asserted. `denied` are asserted facts that do not hold
    from this commit on, as things stand; `undenied` hold again, or are not asserted any more.
    """

    came: tuple[Triple, ...] = ()
    went: tuple[Triple, ...] = ()
    denied: tuple[Triple, ...] = ()
    undenied: tuple[Triple, ...] = ()


class Commit(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """One atomic, checked, durable change. `changed` and `removed` are the entities that it touched.

    `verb` and `undoes` are those of the transaction. `tbox`: it replaced the TBox, so the classes are others.
    A very large commit is published `abridged`, without its triples and entities: whoever follows the map
    takes a new snapshot then. The journal always holds all of it.

    `digest` is that of the journal up to and with this commit, in hexadecimal: where it is the same, so is
    all that came before. Within the journal, which keeps it beside, it is that of the commit before, so that
    each commit can be verified by itself.

    `places` is in what is published only: the journal holds what was said, and not what was worked out. It is
    None where nothing of the kind changed, and for another TBox, with which everything is worked out anew.
    """

    seq: int
    stamp_ns: int
    id: str
    source: Source
    agent: str = ""
    authenticated: bool = False
    """A certificate has proved the agent's name; else it is as somebody said."""
    verb: str = ""
    reason: str = ""
    confidence: Probability | None = None
    undoes: tuple[int, ...] = ()
    tbox: bool = False
    abridged: Extent | None = None
    digest: str = ""
    places: PlaceChanges | None = None
    retracted: tuple[Triple, ...] = ()
    inserted: tuple[Triple, ...] = ()
    changed: tuple[Entity, ...] = ()
    removed: tuple[Departed, ...] = ()
    notes: tuple[str, ...] = ()
    """What else there is to know of it, in words: what it took back, carried along or left behind."""

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
    def extent(self) -> Extent:
        """How much it is, or was before it was abridged."""
        return self.abridged or Extent(
            inserted=len(self.inserted),
            retracted=len(self.retracted),
            changed=len(self.changed),
            removed=len(self.removed),
        )

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the entities that it touched."""
        return tuple(dict.fromkeys(map(_NAME, (*self.changed, *self.removed))))


class Trial(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What a dry run would commit: how many triples, and what would follow and no longer follow.

    The latter in words, of the first entities that it touches.
    """

    inserted: int
    retracted: int
    changed: tuple[str, ...]
    """The names of the entities that it would change, all of them."""
    gained: tuple[str, ...]
    lost: tuple[str, ...]


class Effects(Struct, frozen=True, kw_only=True):
    """What became of the entities: all that a follower of the map needs of a commit.

    A `Commit` can be read as its effects; its triples are skipped, unread.
    """

    seq: int
    id: str
    reason: str = ""
    undoes: tuple[int, ...] = ()
    tbox: bool = False
    abridged: Extent | None = None
    changed: tuple[Entity, ...] = ()
    removed: tuple[Departed, ...] = ()
    notes: tuple[str, ...] = ()
    trial: Trial | None = None
    """Of a dry run: nothing was done."""
    digest: str = ""

    @classmethod
    def of(cls, commit: Commit) -> Effects:
        """Those of `commit`, abridged if there are very many."""
        commit = abridged(commit)
        return cls(
            seq=commit.seq,
            id=commit.id,
            reason=commit.reason,
            undoes=commit.undoes,
            tbox=commit.tbox,
            abridged=commit.abridged,
            changed=commit.changed,
            removed=commit.removed,
            digest=commit.digest,
            notes=commit.notes,
        )

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the entities that it touched."""
        return tuple(dict.fromkeys(map(_NAME, (*self.changed, *self.removed))))


_FEW: Final = 1000


class Transaction(
    Call[Effects | None], frozen=True, kw_only=True, forbid_unknown_fields=True, omit_defaults=True
):
    """One atomic change with its preconditions.

    What is wanted of entities travels as intents: `remove` (names), `edit` and `add`, carried out in this
    order. The knowledge base turns them into triples, because it knows the ones that are there; it raises
    `UnknownName` for an entity that is not there and `NameTaken` for a new one whose name is in use.

    `retract` and `insert` are triples. The transaction is refused with `PreconditionFailed` unless every
    triple of `require` is asserted, and the entities that are to be `unchanged` are there and no commit after
    `since` has changed them. `id` is the command's: the same id a second time changes nothing and is
    answered with the first commit.

    `verb` is that of the command which a client sent; empty for what the system does by itself (the seed,
    settling). `undoes` are the commits that it takes back.
    """

    LARGEST: ClassVar[int] = DOCUMENT

    VERB: ClassVar[str] = "commit"
    id: CommandId
    source: Source
    agent: str = ""
    verb: str = ""
    reason: str = ""
    confidence: Probability | None = None
    undoes: tuple[int, ...] = ()
    remove: tuple[str, ...] = ()
    edit: tuple[Edit, ...] = ()
    add: tuple[NewEntity, ...] = ()
    require: tuple[Triple, ...] = ()
    unchanged: tuple[str, ...] = ()
    since: int = 0
    retract: tuple[Triple, ...] = ()
    insert: tuple[Triple, ...] = ()
    dry_run: bool = False
    """Answered with what it would do, and not done."""
    told: bool = False
    """The coordinator asks: it takes the commit from the reply, and need not hear of it a second time."""

    @property
    def is_quick(self) -> bool:
        """Where it changes few entities and triples."""
        return sum(map(len, (self.add, self.remove, self.edit, self.retract, self.insert))) <= _FEW


MANY_ENTITIES = 10_000
MANY_TRIPLES = 20 * MANY_ENTITIES
"""A commit with more than either is abridged when it is passed on."""


def abridged(commit: Commit, *, always: bool = False) -> Commit:
    """`commit` as it is passed on: one that is very large (or `always`) without its triples and entities."""
    triples = len(commit.inserted) + len(commit.retracted)
    is_small = triples <= MANY_TRIPLES and len(commit.changed) + len(commit.removed) <= MANY_ENTITIES
    if is_small and not always:
        return commit
    return structs.replace(
        commit, abridged=commit.extent, places=None, retracted=(), inserted=(), changed=(), removed=()
    )


class Snapshot(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The entities as they are after commit `seq`: all, or a page of them in the order of their names.

    With `more`, further pages follow. `digest` is that of commit `seq`.
    """

    seq: int
    entities: tuple[Entity, ...]
    more: bool = False
    digest: str = ""


class Star(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The triples about one entity, after commit `seq`."""

    seq: int
    name: str
    iri: Term
    own: tuple[Triple, ...]
    """Its own: they go when it goes. A reference that another entity uses too is not among them."""
    incoming: tuple[Triple, ...]
    """What other individuals say of it."""
    computed: tuple[Triple, ...] = ()
    """Computed facts about it, as subject, which nobody asserted."""
    denied: tuple[Triple, ...] = ()
    """Those of its own that do not hold, as things stand."""
