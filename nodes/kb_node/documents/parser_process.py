"""The process that parses documents and closes TBoxes, within limits of memory and time.

Started as `python -m semmap.nodes.kb_node.documents.parser_process`. It serves one request after another, and
ends when its connection is closed.
"""

from __future__ import annotations

import math
import os
import resource
import signal
import sys
import time
from array import array
from contextlib import suppress
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Final

from msgspec import Struct, msgpack

from semmap.nodes.kb_node.documents import rdf
from semmap.nodes.kb_node.reasoner import Inconsistent, Reasoner
from semmap.nodes.kb_node.reasoner.rules.facts import pack
from semmap.schemas import errors
from semmap.schemas.explanations import Triple

CPU_S: Final = 300.0
"""Time limit of a request [s of CPU time]."""
MEMORY_BYTES: Final = max(1 << 30, os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE") // 2)
"""Limit of the memory of the process."""
OUT_OF_MEMORY: Final = 77
"""The exit status after a failed allocation that Python noticed."""


class Request(Struct, frozen=True, tag=True):
    """A document to parse; see `rdf.read`."""

    content: bytes
    filename: str
    label_prefix: str


class Reply(Struct, frozen=True, tag=True):
    """The parsed document, or the error text of a document that is not valid."""

    error: str = ""
    prefixes: dict[str, str] = {}
    terms: tuple[str, ...] = ()
    """The distinct terms."""
    triples: bytes = b""
    """Three indices of terms for each triple, as unsigned 32-bit integers."""

    @classmethod
    def of(cls, document: rdf.Document) -> Reply:
        """Return the reply with this document."""
        numbers: dict[str, int] = {}
        number = numbers.setdefault
        triples = array("I", (number(term, len(numbers)) for triple in document.triples for term in triple))
        return cls(prefixes=document.prefixes, terms=tuple(numbers), triples=triples.tobytes())

    def document(self) -> rdf.Document:
        """Return the document. Equal terms are the same object. Raises BadFile with the error text."""
        if self.error:
            raise errors.BadFile(self.error)
        terms = map(self.terms.__getitem__, memoryview(self.triples).cast("I"))
        return rdf.Document(list(zip(terms, terms, terms, strict=True)), self.prefixes)


class ClosureRequest(Struct, frozen=True, tag=True):
    """The triples of a TBox whose closure is to be computed."""

    triples: list[Triple]


class ClosureReply(Struct, frozen=True, tag=True):
    """The closure, packed, or b"" if the TBox is inconsistent or not processed separately."""

    packed: bytes


def serve(connection: Connection) -> None:
    """Parse documents within the limits until the connection is closed."""
    _limit_process()
    try:
        while True:
            request = msgpack.decode(connection.recv_bytes(), type=Request | ClosureRequest)
            connection.send_bytes(msgpack.encode(_answer(request)))
    except EOFError:
        pass
    except MemoryError:
        sys.exit(OUT_OF_MEMORY)


def _limit_process() -> None:
    """Limit the memory, write no core file, and let the kernel end this process before others."""
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    with suppress(OSError):  # only Linux has it
        Path("/proc/self/oom_score_adj").write_text("1000")


def _answer(request: Request | ClosureRequest) -> Reply | ClosureReply:
    _, most = resource.getrlimit(resource.RLIMIT_CPU)
    resource.setrlimit(resource.RLIMIT_CPU, (math.ceil(time.process_time() + CPU_S), most))
    return _parse(request) if isinstance(request, Request) else _close(request)


def _parse(request: Request) -> Reply:
    try:
        return Reply.of(rdf.read(request.content, request.filename, label_prefix=request.label_prefix))
    except errors.BadFile as error:
        return Reply(error=error.text)


def _close(request: ClosureRequest) -> ClosureReply:
    try:
        closed = Reasoner(request.triples).closed
    except Inconsistent:
        closed = None
    return ClosureReply(b"" if closed is None else pack(closed))


if __name__ == "__main__":
    serve(Connection(int(sys.argv[1])))
