"""What the knowledge base's node and its SPARQL process say to each other, in MessagePack."""

from __future__ import annotations

from msgspec import Raw, Struct, msgpack

from nodes.kb_node.sparql.dataset import Delta
from schemas.commands import Renew, Sparql, Watch
from schemas.errors import ErrorMessage
from schemas.explanations import Triple
from schemas.sparql import RowsChanged

NOTHING = Raw(msgpack.encode(None))


class Load(Struct, frozen=True, kw_only=True, tag=True):
    """All that is asserted after commit `seq`; with `infers`, what follows is wanted, too.

    The first message, and the one that comes when commits alone do not tell: when what follows is asked for
    the first time, and when the TBox is another.
    """

    seq: int
    asserted: tuple[Triple, ...]
    infers: bool


class Committed(Struct, frozen=True, kw_only=True, tag=True):
    """Every commit from then on, in order."""

    delta: Delta


class Asked(Struct, frozen=True, kw_only=True, tag=True):
    """A command, to be answered under its number."""

    number: int
    command: Sparql | Watch | Renew


class Answered(Struct, frozen=True, kw_only=True, tag=True):
    """The answer: the command's reply, encoded, or the error."""

    number: int
    reply: Raw = NOTHING
    error: ErrorMessage | None = None


class News(Struct, frozen=True, kw_only=True, tag=True):
    """Rows of a standing query have changed; with `ended` there will be no more."""

    rows: RowsChanged | None = None
    watch: str
    ended: bool = False


ToWorker = Load | Committed | Asked
FromWorker = Answered | News

to_worker = msgpack.Decoder(ToWorker)
from_worker = msgpack.Decoder(FromWorker)
