"""What the coordinator asks of the knowledge base, besides `commit` (schemas/commits.py)."""

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
    Get,
    History,
    Infer,
    LastSeen,
    Properties,
    Relations,
    Renew,
    Sparql,
    Tell,
    Understand,
    WasWhen,
    Watch,
)
from semmap.schemas.commits import Commit, Effects, Snapshot, Star, Transaction
from semmap.schemas.entities import CommandId, Entity, Source, Word
from semmap.schemas.errors import ErrorMessage
from semmap.schemas.explanations import Triple
from semmap.schemas.moments import When
from semmap.schemas.plans import Clearance, HeightRange, Outline, Plan, Way
from semmap.schemas.relations import Where


class Outcome(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What became of one of several changes: an error, or else the commit (None when it changed nothing)."""

    commit: Effects | None = None
    error: ErrorMessage | None = None


class Loaded(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The commit, the last of so many `parts`; the names of all entities that changed; what was left out."""

    commit: Effects | None
    parts: int = 1
    names: tuple[str, ...] = ()
    skipped: tuple[str, ...]
    notes: tuple[str, ...] = ()


class SnapshotQuery(Call[Snapshot], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The entities, with the number of the commit that they are true after.

    With a `limit`, a page of that many at most: those whose names come after `after`, in their order. Other
    commits may come between two pages; who follows those and takes them all in has the map in the end.
    """

    VERB: ClassVar[str] = "snapshot"
    after: str = ""
    limit: Annotated[int, Meta(ge=1, le=1_000_000)] | None = None


class MapCopy(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A map as it is after commit `seq`, for who keeps it elsewhere and follows its commits from there.

    Its `triples` are all that was asserted and is not the TBox's; blank nodes have the labels that commits
    call them by.
    """

    map_id: str
    """The digest of the map's very first commit: a map that is begun anew has another."""
    begun_ns: int
    """When that was made."""
    seq: int
    digest: str
    """That of all commits up to `seq`."""
    stamp_ns: int
    """When commit `seq` was made."""
    triples: tuple[Triple, ...] = ()
    entities: tuple[Entity, ...] = ()


class CopyQuery(Call[MapCopy], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The whole map; without `content` only which map it is, and as of which commit."""

    VERB: ClassVar[str] = "copy"
    content: bool = True


class StarQuery(Call[tuple[Star, ...]], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The stars of these entities, taken together; UnknownName if one is not there."""

    LARGEST: ClassVar[int] = MANY

    VERB: ClassVar[str] = "star"

    names: tuple[str, ...]

    @property
    def is_quick(self) -> bool:
        """It is."""
        return True


class LoadOf(Call[tuple[str, ...]], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What a thing bears: all that stands on it or is inside it, what bears before what is borne.

    Not what `leave` names, nor what only that bears. Refused for a place, and for what has no position.
    """

    VERB: ClassVar[str] = "load-of"

    name: str
    leave: tuple[str, ...] = ()


class MadeBy(Call[tuple[Effects | None, ...]], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The commits that these commands have made already; None for a command that has made none."""

    LARGEST: ClassVar[int] = MANY

    VERB: ClassVar[str] = "made-by"

    ids: tuple[CommandId, ...]

    @property
    def is_quick(self) -> bool:
        """It is."""
        return True


class Recall(Call[tuple[Commit, ...]], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """These commits again, for a follower that has missed them; those that there never were are left out."""

    VERB: ClassVar[str] = "recall"

    seqs: Annotated[tuple[Annotated[int, Meta(ge=0, le=1 << 53)], ...], Meta(max_length=100)]

    @property
    def is_quick(self) -> bool:
        """It is."""
        return True


class Transactions(Call[tuple[Outcome, ...]], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Several changes, each accepted or refused by itself in this order, and made durable together."""

    LARGEST: ClassVar[int] = DOCUMENT

    VERB: ClassVar[str] = "commits"

    transactions: tuple[Transaction, ...]

    @property
    def is_quick(self) -> bool:
        """It is."""
        return True


class LoadDocument(Call[Loaded], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Add an ABox in any RDF syntax, with `replace` instead of the present one; see `commands.Load`."""

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
    strict: bool = False
    parts: bool = False
    dry_run: bool = False
    told: bool = False
    """The coordinator asks for one commit, and takes it from the reply; see `Transaction.told`."""


class LoadTBox(Call[Loaded], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Let the TBox of a document, in any RDF syntax, replace the present one, or be added to it (`extend`).

    `spatial_root` are the classes of things in space, by IRI or name, where that is not known by itself.
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
    dry_run: bool = False


class Entities(Call[tuple[Entity, ...]], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The entities of a class, given by its exact name (all, without one); with `as_of` those of then.

    With `where` only those that are there; by distance if it asks for the nearest.
    """

    VERB: ClassVar[str] = "list"
    class_: str | None = field(name="class", default=None)
    as_of: When | None = None
    where: Where | None = None

    @property
    def is_quick(self) -> bool:
        """It is."""
        return True


class PlanOf(Call[Plan], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The plan of the map; `walls` are those of the simulated world, None without one."""

    LARGEST: ClassVar[int] = MANY

    VERB: ClassVar[str] = "floorplan"
    as_of: When | None = None
    walls: tuple[Outline, ...] | None = None


class WayOf(Call[Way], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A way through the map; see `semmap.schemas.commands.FindWay`, and `PlanOf` for the walls."""

    LARGEST: ClassVar[int] = MANY

    VERB: ClassVar[str] = "route"
    from_: Word = field(name="from")
    to: Word
    radius: Clearance
    heights: HeightRange
    as_of: When | None = None
    walls: tuple[Outline, ...] | None = None


class TakeBack(Call[Effects | None], frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Take back a commit by another one; see `semmap.schemas.commands.Undo`."""

    VERB: ClassVar[str] = "undo"
    id: CommandId
    source: Source
    agent: str = ""
    reason: str = ""
    commit: Annotated[int, Meta(ge=1, le=1 << 53)] | None = None
    dry_run: bool = False
    told: bool = False
    """The coordinator asks; see `Transaction.told`."""


BRIDGE: dict[str, type[Call]] = {
    call.VERB: call
    for call in (
        *(Transaction, Transactions, LoadDocument, LoadTBox, TakeBack),
        *(SnapshotQuery, CopyQuery, Recall, StarQuery, MadeBy, Entities, PlanOf, WayOf),
        *(
            Classes,
            Properties,
            Get,
            Check,
            Infer,
            Explain,
            Could,
            Export,
            History,
            LastSeen,
            Relations,
            *(Understand, Find, Tell, Diff, WasWhen),
        ),
        *(Sparql, Watch, Renew),
        *(Backup, Compact),
    )
}
"""Verb to type: what `semmap/bridge/<verb>` takes."""
