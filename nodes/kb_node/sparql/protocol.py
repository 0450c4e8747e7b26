"""What the knowledge base's node and its SPARQL process say to each other, in MessagePack."""

from __future__ import annotations

from typing import Any

from msgspec import Struct, msgpack

from nodes.kb_node.sparql.dataset import Delta
from schemas.commands import Renew, Sparql, Watch
from schemas.errors import ErrorMessage
from schemas.explanations import Triple
from schemas.sparql import RowsChanged


class Start(Struct, frozen=True, kw_only=True, tag=True):
    """The first message: all that is asserted after commit `seq`."""

    seq: int
    asserted: tuple[Triple, ...]


class Infer(Struct, frozen=True, kw_only=True, tag=True):
    """Work out what follows, from now on, of all that is asserted now."""

    asserted: tuple[Triple, ...]


class Committed(Struct, frozen=True, kw_only=True, tag=True):
    """Every commit from then on, in order."""

    delta: Delta


class Asked(Struct, frozen=True, kw_only=True, tag=True):
    """A command, to be answered under its number."""

    number: int
    command: Sparql | Watch | Renew


class Answered(Struct, frozen=True, kw_only=True, tag=True):
    """The answer: the message that the command's reply is, or the error."""

    number: int
    reply: Any = None
    error: ErrorMessage | None = None


class News(Struct, frozen=True, kw_only=True, tag=True):
    """Rows of a standing query have changed; with `ended` there will be no more."""

    rows: RowsChanged | None = None
    watch: str
    ended: bool = False


ToWorker = Start | Infer | Committed | Asked
FromWorker = Answered | News

to_worker = msgpack.Decoder(ToWorker)
from_worker = msgpack.Decoder(FromWorker)
