"""Requests to the knowledge base, besides `commit` (schemas/commits.py)."""

from __future__ import annotations

from typing import Annotated, ClassVar

from msgspec import Meta, Struct, field

from semmap.schemas.calls import DOCUMENT, MANY, Call
from semmap.schemas.commands import (
    Backup,
    Check,
    Classes,
    Compact,
    Could,
    Diff,
    Explain,
    Export,
    Find,
    FindTrail,
    Get,
    History,
    Infer,
    LastSeen,
    Properties,
    Relations,
    Renew,
    Rules,
    Sparql,
    Tell,
    Understand,
    WasWhen,
    Watch,
)
from semmap.schemas.commits import Commit, Effects, Snapshot, Star, Transaction
from semmap.schemas.entities import CommandId, Entity, Pose, Quaternion, Size, Source, Word
from semmap.schemas.errors import ErrorMessage
from semmap.schemas.explanations import Triple
from semmap.schemas.joints import select_joint_properties
from semmap.schemas.moments import When
from semmap.schemas.plans import Clearance, HeightRange, Outline, Plan, Way
from semmap.schemas.relations import Placing, Where
from semmap.schemas.replies import Done


class Outcome(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The result of one of several transactions: an error, or the commit (None if nothing changed)."""

    commit: Effects | None = None
    error: ErrorMessage | None = None


class Loaded(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The result of loading: the last commit of `parts` parts, the changed entities, and skipped ones.

    `counts` has the number of entities that the document describes by what changed: `new`, `moved`, ...
    """

    commit: Effects | None
    parts: int = 1
    names: tuple[str, ...] = ()
    counts: dict[str, int] = {}
    skipped: tuple[str, ...]
    notes: tuple[str, ...] = ()


class SnapshotQuery(Call[Snapshot], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Request the entities, with the number of the last commit.

    With a `limit`, the reply is a page of at most so many entities, sorted by name, that follow the name
    `after`. Commits between two pages must be applied by the client to get a consistent map.
    """

    VERB: ClassVar[str] = "snapshot"
    after: str = ""
    limit: Annotated[int, Meta(ge=1, le=1_000_000)] | None = None


class MapCopy(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A map after commit `seq`, for a mirror that applies the later commits.

    `triples` are all asserted triples outside the TBox; blank nodes have the same labels as in commits.
    """

    map_id: str
    """The digest of the first commit, which identifies the map."""
    begun_ns: int
    """The time of the first commit."""
    seq: int
    digest: str
    """The digest of all commits up to `seq`."""
    stamp_ns: int
    """The time of commit `seq`."""
    triples: tuple[Triple, ...] = ()
    entities: tuple[Entity, ...] = ()


class CopyQuery(Call[MapCopy], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Request the whole map, or without `content` only its identity and last commit."""

    VERB: ClassVar[str] = "copy"
    content: bool = True


class PlacedObject(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """An object or place that is about to be added to the map."""

    name: str
    model: str
    pose: Pose
    size_m: Size | None = None
    place: bool = False


class Room(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A free pose for an object. `note` is about the object that it is placed on or in, or ""."""

    pose: Pose
    note: str = ""


class FindRoom(Call[Room], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Request a free pose for an object `name` on, in or next to `target`.

    Without an `orientation` it is aligned with the target. `model` and `size_m` replace those of an entity of
    this name. With `carry`, its contents take up no room. `others` are objects that are not in the map yet;
    with `alone`, they replace the map. With `stays`, an object for which the relation holds already keeps its
    pose. Raises Refused without room, with the reason.
    """

    VERB: ClassVar[str] = "find-room"

    name: str
    model: str | None = None
    size_m: Size | None = None
    orientation: Quaternion | None = None
    placing: Placing
    target: str
    carry: bool = False
    others: tuple[PlacedObject, ...] = ()
    alone: bool = False
    stays: bool = False


class StarQuery(Call[tuple[Star, ...]], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Request the entity triples of several entities. Raises UnknownName if one does not exist."""

    LARGEST: ClassVar[int] = MANY

    VERB: ClassVar[str] = "star"

    names: tuple[str, ...]

    @property
    def is_quick(self) -> bool:
        """Always true."""
        return True


class LoadOf(Call[tuple[str, ...]], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Request the names of all objects on or inside an object; supports come before what they support.

    The objects in `leave`, and objects that only they support, are excluded. Raises Refused for a place, and
    for an entity without a position.
    """

    VERB: ClassVar[str] = "load-of"

    name: str
    leave: tuple[str, ...] = ()


class MadeBy(Call[tuple[Effects | None, ...]], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Request the commits of these commands; None for a command without a commit."""

    LARGEST: ClassVar[int] = MANY

    VERB: ClassVar[str] = "made-by"

    ids: tuple[CommandId, ...]

    @property
    def is_quick(self) -> bool:
        """Always true."""
        return True


class Recall(Call[tuple[Commit, ...]], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Request commits by number, for a subscriber that missed them; nonexistent ones are left out."""

    VERB: ClassVar[str] = "recall"

    seqs: Annotated[tuple[Annotated[int, Meta(ge=0, le=1 << 53)], ...], Meta(max_length=100)]

    @property
    def is_quick(self) -> bool:
        """Always true."""
        return True


class Transactions(Call[tuple[Outcome, ...]], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Several transactions, accepted or rejected one by one in this order, and made durable together."""

    LARGEST: ClassVar[int] = DOCUMENT

    VERB: ClassVar[str] = "commits"

    transactions: tuple[Transaction, ...]

    @property
    def is_quick(self) -> bool:
        """Always true."""
        return True


class LoadDocument(Call[Loaded], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Load an ABox in any RDF syntax, or with `replace` replace the present one; see `commands.Load`."""

    LARGEST: ClassVar[int] = DOCUMENT

    VERB: ClassVar[str] = "load"

    id: CommandId
    source: Source
    agent: str = ""
    reason: str = ""
    content: bytes
    filename: str
    replace: bool
    skip_unknown: bool
    add_only: bool = False
    graph: str = ""
    urdf: bytes = b""
    strict: bool = False
    parts: bool = False
    tbox_from_abox: bool = False
    dry_run: bool = False
    told: bool = False
    """Sent by the coordinator, which takes the commit from the reply; see `Transaction.told`."""


class LoadTBox(Call[Loaded], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Replace the TBox by that of a document in any RDF syntax, or extend it by the document (`extend`).

    `spatial_root` are the classes of physical things, by IRI or name, if the TBox does not show it.
    """

    LARGEST: ClassVar[int] = DOCUMENT

    VERB: ClassVar[str] = "load-tbox"

    id: CommandId
    source: Source
    agent: str = ""
    reason: str = ""
    content: bytes
    filename: str
    spatial_root: tuple[str, ...] = ()
    extend: bool = False
    graph: str = ""
    dry_run: bool = False


class Entities(Call[tuple[Entity, ...]], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Request the entities of a class, by its exact name (or all); with `as_of`, at that time.

    `where` restricts them by position; the nearest ones are sorted by distance. With `all`, the individuals
    that are not in space follow; this is for the present only, and without `where`.
    """

    VERB: ClassVar[str] = "list"
    class_: str | None = field(name="class", default=None)
    all: bool = False
    as_of: When | None = None
    where: Where | None = None

    @property
    def is_quick(self) -> bool:
        """Always true."""
        return True


class PlanOf(Call[Plan], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Request the floor plan; `walls` are those of the simulated world, None without one."""

    LARGEST: ClassVar[int] = MANY

    VERB: ClassVar[str] = "floorplan"
    as_of: When | None = None
    walls: tuple[Outline, ...] | None = None


class WayOf(Call[Way], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Request a path; see `semmap.schemas.commands.FindWay`, and `PlanOf` for the walls."""

    LARGEST: ClassVar[int] = MANY

    VERB: ClassVar[str] = "route"
    from_: Word = field(name="from")
    to: Word
    radius: Clearance
    heights: HeightRange
    as_of: When | None = None
    walls: tuple[Outline, ...] | None = None


class TakeBack(Call[Effects | None], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Undo a commit by another one; see `semmap.schemas.commands.Undo`."""

    VERB: ClassVar[str] = "undo"
    id: CommandId
    source: Source
    agent: str = ""
    reason: str = ""
    commit: Annotated[int, Meta(ge=1, le=1 << 53)] | None = None
    dry_run: bool = False
    told: bool = False
    """Sent by the coordinator; see `Transaction.told`."""


class ShapeBodies(Call[Done], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """State the shapes of the bodies of the present world file, from which relations are computed.

    `content` is JSON: `shapes` by digest, and the digest of each body by name (`ontology/model_shapes.py`).
    """

    LARGEST: ClassVar[int] = MANY

    VERB: ClassVar[str] = "shapes"
    content: bytes

    @property
    def is_quick(self) -> bool:
        """Always true."""
        return True


class ShapeKey(Struct, frozen=True, gc=False, kw_only=True, forbid_unknown_fields=True, omit_defaults=True):
    """The part of an entity, as of any commit, that its shape depends on."""

    name: str
    model: str = ""
    size_m: Size | None = None
    joints: tuple[tuple[str, bool | float | str], ...] = ()
    """The properties for the positions of its joints, with their values."""

    @classmethod
    def of(cls, entity: Entity) -> ShapeKey:
        """Return the key of an entity's shape."""
        joints = () if not entity.properties else tuple(select_joint_properties(entity.properties).items())
        return cls(name=entity.name, model=entity.model, size_m=entity.size_m, joints=joints)


class FoundShapes(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The shapes of entities: `content` is JSON as in `ShapeBodies`, with any keys instead of digests."""

    content: bytes


class ShapesOf(Call[FoundShapes], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Request the shapes of entities at their sizes, with their joints at the asserted positions.

    An entity without a size and without a model is left out.
    """

    LARGEST: ClassVar[int] = MANY

    VERB: ClassVar[str] = "shapes-of"
    keys: Annotated[tuple[ShapeKey, ...], Meta(max_length=1000)]

    @property
    def is_quick(self) -> bool:
        """Always true."""
        return True


BRIDGE: dict[str, type[Call]] = {
    call.VERB: call
    for call in (
        *(Transaction, Transactions, LoadDocument, LoadTBox, TakeBack),
        *(SnapshotQuery, CopyQuery, Recall, StarQuery, MadeBy, Entities, PlanOf, WayOf),
        *(
            Classes,
            Properties,
            Rules,
            Get,
            Check,
            Infer,
            Explain,
            Could,
            Export,
            History,
            LastSeen,
            Relations,
            *(Understand, Find, Tell, Diff, WasWhen, FindTrail),
        ),
        *(Sparql, Watch, Renew),
        *(Backup, Compact, ShapeBodies, ShapesOf),
    )
}
"""The request types of `semmap/bridge/<verb>`."""
