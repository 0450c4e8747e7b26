"""Messages between the knowledge base's node, its SPARQL process and the readers, in MessagePack."""

from __future__ import annotations

from msgspec import Raw, Struct, field, msgpack

from semmap.nodes.kb_node.derived_facts import UNCHANGED, DerivedChanges
from semmap.nodes.kb_node.relations.geometry.placed_entity import PlacedEntity
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from semmap.nodes.kb_node.sparql.triples.dataset import Delta
from semmap.ontology.model_shapes import AddedShapes, added_shapes
from semmap.schemas import codec
from semmap.schemas.commands import Renew, Watch
from semmap.schemas.errors import ErrorMessage
from semmap.schemas.explanations import Triple
from semmap.schemas.sparql import RowsChanged

NOTHING = Raw(msgpack.encode(None))


class Placements(Struct, frozen=True, kw_only=True, tag=True):
    """The poses of all entities, for queries that need measurements. Commits update them from then on."""

    placed: tuple[PlacedEntity, ...]
    limits: Thresholds
    shapes: AddedShapes = field(default_factory=added_shapes)
    """The shapes that are not of the library, which the other process lacks."""


class Load(Struct, frozen=True, kw_only=True, tag=True):
    """All asserted triples after commit `seq`; with `infers`, inferred triples are needed, too.

    It is the first message. It is repeated when inference is requested for the first time and when the TBox
    changes.
    """

    seq: int
    asserted: tuple[Triple, ...]
    infers: bool
    derived_changes: DerivedChanges = UNCHANGED
    """The computed and suppressed facts, if inference is needed."""
    closure: bytes = b""
    """The closure of the TBox as `facts.pack` writes it, if inference is needed and the closure is known."""
    placements: Placements | None = None


class LoadFromDisk(Struct, frozen=True, kw_only=True, tag=True):
    """Used instead of `Load`: the triples are in the store at `path`.

    The store has all commits up to `seq` and some of those up to `settled`. It is consistent only after all
    of these are applied.
    """

    path: str
    seq: int
    settled: int


class Committed(Struct, frozen=True, kw_only=True, tag=True):
    """A commit; all later commits are sent in order."""

    delta: Delta
    derived_changes: DerivedChanges = UNCHANGED
    """The changes of computed and suppressed facts, if inference is needed."""
    placed: tuple[PlacedEntity, ...] = ()
    """The changed entities, and (`removed`) the names of removed ones, after `Placements`."""
    removed: tuple[str, ...] = ()


class MeasurementRequest(Struct, frozen=True, kw_only=True, tag=True):
    """A query that may need measurements. They must be available under the number `demand`."""

    demand: int
    query: str


class StandingCommand(Struct, frozen=True, kw_only=True, tag=True):
    """A command about a standing query; the reply has its number."""

    number: int
    command: Watch | Renew


class StartReader(Struct, frozen=True, kw_only=True, tag=True):
    """A lane needs a reader."""

    lane: int


class StopReader(Struct, frozen=True, kw_only=True, tag=True):
    """Stop the reader of a lane, because its query was preempted."""

    lane: int


class CommandReply(Struct, frozen=True, kw_only=True, tag=True):
    """The encoded reply to a command, or its error."""

    number: int
    reply: Raw = NOTHING
    error: ErrorMessage | None = None


class ReaderExited(Struct, frozen=True, kw_only=True, tag=True):
    """The reader of a lane has exited: killed by a signal, or (0) because its triples were too old."""

    lane: int
    signal: int


class QueryUpdate(Struct, frozen=True, kw_only=True, tag=True):
    """Changed rows of a standing query; with `ended` it is the last update."""

    rows: RowsChanged | None = None
    watch: str
    ended: bool = False


class QueryRequest(Struct, frozen=True, kw_only=True):
    """A query for a reader, to be answered as of commit `seq` or later on the same lane."""

    number: int
    seq: int
    query: str
    inferred: bool
    limit: int
    timeout_s: float
    demand: int = 0
    """The number of the measurements that it needs; 0 for none."""


class QueryOutcome(Struct, frozen=True, kw_only=True):
    """The encoded `SparqlResult` or the error; or the reader is too `old` and exits."""

    number: int
    result: Raw = NOTHING
    error: ErrorMessage | None = None
    old: bool = False


ToWorker = (
    Load
    | LoadFromDisk
    | Placements
    | Committed
    | MeasurementRequest
    | StandingCommand
    | StartReader
    | StopReader
)
FromWorker = CommandReply | ReaderExited | QueryUpdate

to_worker = codec.decoder(ToWorker)
from_worker = codec.decoder(FromWorker)
questions = codec.decoder(QueryRequest)
outcomes = codec.decoder(QueryOutcome)
