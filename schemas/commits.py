"""Changes of the map: transactions, and the commits they result in."""

from __future__ import annotations

from collections.abc import Mapping
from operator import attrgetter
from typing import ClassVar, Final

from msgspec import Struct, structs

from semmap.schemas import errors
from semmap.schemas.calls import DOCUMENT, Call
from semmap.schemas.entities import (
    CommandId,
    Entity,
    Name,
    Pose,
    Probability,
    Provenance,
    Quaternion,
    Radians,
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
    """A property, by name or label, with values as written; no values stand for all."""

    property: str
    values: tuple[str, ...] = ()


class NewEntity(Struct, frozen=True, gc=False, kw_only=True, forbid_unknown_fields=True, omit_defaults=True):
    """An entity to add, under a name that must not exist; positions and sizes are in metres."""

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
    """A change of an entity; omitted fields keep their values.

    `alt` replaces all aliases. An empty `conflict` clears the present one. `unset` is applied before `set`,
    which replaces the value of a functional property and adds values to other properties. The edit is
    rejected with `PreconditionFailed` unless the properties of `only_if` have one of the given values (or no
    value, if none is given). With `carry`, objects on the entity or inside it move with it as one rigid body,
    except those in `leave`. An empty `tracked` ends tracking. `rename` is the new name, which must be free;
    other individuals then refer to the entity under it.
    """

    name: str
    rename: Name | None = None
    class_iri: str | None = None
    at: Vector | None = None
    yaw: Radians | None = None
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
        """Whether it changes the pose."""
        return not (self.at is None and self.yaw is None and self.orientation is None)

    def pose_after(self, before: Pose | None) -> Pose:
        """Return the new pose. Raises BadRequest for an invalid pose."""
        at = self.at or (before.position_m if before is not None else None)
        if at is None:
            raise errors.BadRequest(f"{self.name} has no position; give one with --at")
        return pose_of(at, self.yaw, self.orientation, before)


class Departed(Struct, frozen=True, gc=False, kw_only=True, forbid_unknown_fields=True):
    """An entity that left the map, with the classes it had."""

    name: str
    types: tuple[str, ...]


class Extent(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The number of triples and entities of a commit."""

    inserted: int
    retracted: int
    changed: int
    removed: int


class PlaceChanges(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, omit_defaults=True):
    """The changes of spatial relations by a commit, besides its asserted and retracted triples.

    `came` and `went` are computed facts. `denied` are asserted facts that the geometry contradicts from this
    commit on. `undenied` are facts that hold again or are no longer asserted.
    """

    came: tuple[Triple, ...] = ()
    went: tuple[Triple, ...] = ()
    denied: tuple[Triple, ...] = ()
    undenied: tuple[Triple, ...] = ()


class Commit(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """One atomic, checked, durable change. `changed` and `removed` are the affected entities.

    `verb` and `undoes` are those of the transaction. With `tbox`, it replaced the TBox and thereby the
    classes. A very large commit is published `abridged`, without its triples and entities; subscribers then
    fetch a new snapshot. The journal always contains the whole commit.

    `digest` covers the journal up to and including this commit, in hexadecimal: equal digests mean equal
    histories. In the journal, which stores the digest separately, the field has the digest of the previous
    commit, so that each commit can be verified alone.

    `places` is only in published commits, as the journal does not store computed facts. It is None if no
    spatial relation changed, and for a new TBox, for which all relations are computed again.
    """

    seq: int
    stamp_ns: int
    id: str
    source: Source
    agent: str = ""
    authenticated: bool = False
    """Whether the agent's name was authenticated by a certificate."""
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
    """Notes about the commit: what it undid, moved along or left in place."""

    @property
    def provenance(self) -> Provenance:
        """The provenance of the changed facts."""
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
        """The size of the commit, before it was abridged."""
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
    """The result of a dry run: the number of triples, and the inferences gained and lost.

    Inferences are given as text, for the first affected entities.
    """

    inserted: int
    retracted: int
    changed: tuple[str, ...]
    """The names of all entities that would change."""
    gained: tuple[str, ...]
    lost: tuple[str, ...]


class Effects(Struct, frozen=True, kw_only=True):
    """The part of a commit that subscribers to entities need.

    A `Commit` can be decoded as `Effects`; its triples are skipped.
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
    """The result of a dry run; nothing was changed."""
    digest: str = ""
    renamed: Mapping[str, str] = {}
    """The earlier names of renamed entities, by their present names; only in replies."""

    @classmethod
    def of(cls, commit: Commit, renamed: Mapping[str, str] | None = None) -> Effects:
        """Return the effects of a commit, abridged if there are very many."""
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
            renamed=renamed or {},
        )

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the entities that it touched."""
        return tuple(dict.fromkeys(map(_NAME, (*self.changed, *self.removed))))


_FEW: Final = 1000


class Reserved(Struct, frozen=True, gc=False, kw_only=True, forbid_unknown_fields=True):
    """Properties of entities that edits must not change, neither directly nor by a property that implies one.

    `why` ends the error "PROPERTY of NAME ..."; `{name}` in it is the name of the entity.
    """

    names: tuple[str, ...]
    properties: tuple[str, ...]
    why: str


class Transaction(
    Call[Effects | None], frozen=True, kw_only=True, forbid_unknown_fields=True, omit_defaults=True
):
    """One atomic change with its preconditions.

    Changes of entities are given as `remove` (names), `edit` and `add`, which are applied in this order. The
    knowledge base converts them to triples. It raises `UnknownName` for an entity that does not exist and
    `NameTaken` for a new entity whose name exists.

    `retract` and `insert` are triples. The transaction is rejected with `PreconditionFailed` unless every
    triple of `require` is asserted, and the entities in `unchanged` exist and were not changed by a commit
    after `since`. `id` is the command's: if a transaction with the same id was committed before, nothing
    changes, and the reply is the first commit.

    `verb` is the name of the client's command; it is empty for changes by the system itself (the seed,
    settling). `undoes` are the commits that it undoes.
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
    reserved: tuple[Reserved, ...] = ()
    """It is rejected if it changes any of these properties."""
    retract: tuple[Triple, ...] = ()
    insert: tuple[Triple, ...] = ()
    others: bool = False
    """Also remove everything that is asserted about individuals that are not entities."""
    dry_run: bool = False
    """Only report the effects, without changing anything."""
    told: bool = False
    """Sent by the coordinator, which takes the commit from the reply and needs no publication of it."""

    @property
    def is_quick(self) -> bool:
        """Whether it changes few entities and triples."""
        if self.others:
            return False
        return sum(map(len, (self.add, self.remove, self.edit, self.retract, self.insert))) <= _FEW


MANY_ENTITIES = 10_000
MANY_TRIPLES = 20 * MANY_ENTITIES
"""A commit with more than either is published abridged."""


def abridged(commit: Commit, *, always: bool = False) -> Commit:
    """Return `commit` as it is published: without triples and entities if it is very large (or `always`)."""
    triples = len(commit.inserted) + len(commit.retracted)
    is_small = triples <= MANY_TRIPLES and len(commit.changed) + len(commit.removed) <= MANY_ENTITIES
    if is_small and not always:
        return commit
    return structs.replace(
        commit, abridged=commit.extent, places=None, retracted=(), inserted=(), changed=(), removed=()
    )


class Snapshot(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The entities after commit `seq`: all of them, or a page sorted by name.

    `more` means that further pages follow. `digest` is that of commit `seq`.
    """

    seq: int
    entities: tuple[Entity, ...]
    more: bool = False
    digest: str = ""


class Star(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The entity triples of one entity, after commit `seq`."""

    seq: int
    name: str
    iri: Term
    own: tuple[Triple, ...]
    """Triples that are removed with the entity, excluding a label that another entity shares."""
    incoming: tuple[Triple, ...]
    """Triples of other individuals with this entity as object."""
    computed: tuple[Triple, ...] = ()
    """Computed facts with this entity as subject."""
    denied: tuple[Triple, ...] = ()
    """The triples in `own` that the geometry contradicts."""
