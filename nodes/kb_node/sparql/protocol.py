"""What the knowledge base's node, its SPARQL process and the readers say to each other, in MessagePack."""

from __future__ import annotations

from msgspec import Raw, Struct, msgpack

from semmap.nodes.kb_node.derived_facts import UNCHANGED, DerivedChanges
from semmap.nodes.kb_node.relations.geometry.placed import Placed
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from semmap.nodes.kb_node.sparql.triples.dataset import Delta
from semmap.schemas import codec
from semmap.schemas.commands import Renew, Watch
from semmap.schemas.errors import ErrorMessage
from semmap.schemas.explanations import Triple
from semmap.schemas.sparql import RowsChanged

NOTHING = Raw(msgpack.encode(None))


class Placements(Struct, frozen=True, kw_only=True, tag=True):
    """Where everything is: what a question may need to have measured. Commits tell the rest from then on."""

    placed: tuple[Placed, ...]
    limits: Thresholds


class Load(Struct, frozen=True, kw_only=True, tag=True):
    """All that is asserted after commit `seq`; with `infers`, what follows is wanted, too.

    The first message, and the one that comes when commits alone do not tell: when what follows is asked for
    the first time, and when the TBox is another.
    """

    seq: int
    asserted: tuple[Triple, ...]
    infers: bool
    derived_changes: DerivedChanges = UNCHANGED
    """What is computed, and what is set aside, if what follows is wanted."""
    placements: Placements | None = None


class LoadFromDisk(Struct, frozen=True, kw_only=True, tag=True):
    """Instead of `Load`: the triples are in the store at `path`.

    It has all commits up to `seq` and some of those up to `settled`, which follow: only with all of these it
    is a map.
    """

    path: str
    seq: int
    settled: int


class Committed(Struct, frozen=True, kw_only=True, tag=True):
    """Every commit from then on, in order."""

    delta: Delta
    derived_changes: DerivedChanges = UNCHANGED
    """What it changes of what is computed and set aside, if what follows is wanted."""
    placed: tuple[Placed, ...] = ()
    """The entities that it changes, and the names of those that went, after `Placements`."""
    removed: tuple[str, ...] = ()


class MeasurementRequest(Struct, frozen=True, kw_only=True, tag=True):
    """A query that may look at what has to be measured; what it needs is to be there under this number."""

    demand: int
    query: str


class StandingCommand(Struct, frozen=True, kw_only=True, tag=True):
    """A command about a standing query, to be answered under its number."""

    number: int
    command: Watch | Renew


class StartReader(Struct, frozen=True, kw_only=True, tag=True):
    """A lane has no reader and needs one."""

    lane: int


class StopReader(Struct, frozen=True, kw_only=True, tag=True):
    """The reader of a lane is to be ended: its query has been set aside."""

    lane: int


class CommandReply(Struct, frozen=True, kw_only=True, tag=True):
    """The answer: the command's reply, encoded, or the error."""

    number: int
    reply: Raw = NOTHING
    error: ErrorMessage | None = None


class ReaderExited(Struct, frozen=True, kw_only=True, tag=True):
    """A lane's reader is no more: it died of a signal, or (0) went because its triples were too old."""

    lane: int
    signal: int


class QueryUpdate(Struct, frozen=True, kw_only=True, tag=True):
    """Rows of a standing query have changed; with `ended` there will be no more."""

    rows: RowsChanged | None = None
    watch: str
    ended: bool = False


class QueryRequest(Struct, frozen=True, kw_only=True):
    """A query, to be answered by a reader as of commit `seq` or later, on the lane that it came on."""

    number: int
    seq: int
    query: str
    inferred: bool
    limit: int
    timeout_s: float
    demand: int = 0
    """What was measured under this number is needed, too; 0 for nothing."""


class QueryOutcome(Struct, frozen=True, kw_only=True):
    """What came of it: a `SparqlResult`, encoded, or the error; or the reader is too `old` and goes."""

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
