"""Parses documents of unknown origin in a separate process, which may fail without harm.

Turtle and N-Triples are the exception. They are read as a stream, without recursion over what
`schemas/nesting.py` limits, and the result of a large file would take longer to transfer than to parse. All
other syntaxes have native parsers that build the whole document in memory.
"""

from __future__ import annotations

import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from multiprocessing.connection import Connection, Pipe
from typing import Final, Self, TypeVar

from msgspec import msgpack

from semmap.nodes.kb_node.documents import rdf
from semmap.nodes.kb_node.documents.blank_nodes import require_shallow_expressions
from semmap.nodes.kb_node.documents.parser_process import (
    CPU_S,
    MEMORY_BYTES,
    OUT_OF_MEMORY,
    ClosureReply,
    ClosureRequest,
    Reply,
    Request,
)
from semmap.nodes.kb_node.reasoner.rules.facts import Facts, unpack
from semmap.schemas import errors
from semmap.schemas.explanations import Triple

_COMMAND: Final = (sys.executable, "-P", "-m", "semmap.nodes.kb_node.documents.parser_process")
_WALL_S: Final = 2 * CPU_S
"""Time limit of a document on a busy machine."""
_END_S: Final = 10.0
"""Time in which a process ends after it closed its connection."""
_LARGE: Final = 1 << 20
"""Size of a document from which its process is not kept for the next one, because its memory grew [bytes]."""

R = TypeVar("R")


class IsolatedParser:
    """Serves one request at a time. The process starts with the first document that needs it."""

    def __init__(self, command: Sequence[str] = _COMMAND, *, wall_s: float = _WALL_S) -> None:
        """Create it; `command` is the program of the process, which gets the number of its connection."""
        self._command = command
        self._wall_s = wall_s
        self._turn = threading.Lock()
        self._process: subprocess.Popen[bytes] | None = None
        self._connection: Connection | None = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @staticmethod
    def isolates(content: bytes) -> bool:
        """Return whether a document is parsed in the process."""
        return rdf.syntax_of(content) != "turtle"

    def read(
        self,
        content: bytes,
        filename: str,
        label_prefix: str = "",
        progress: Callable[[int], None] = lambda _: None,
    ) -> rdf.Document:
        """Read a document like `rdf.read`. Any thread may call this.

        Raises BadFile also for a document that ends its process or exceeds a limit, and for class expressions
        that are nested too deeply. `progress` is called only for documents that are not isolated.
        """
        if self.isolates(content):
            with self._turn:
                reply = self._exchange(Request(content, filename, label_prefix), Reply, filename)
                if len(content) > _LARGE:
                    self._discard()
            document = reply.document()
        else:
            document = rdf.read(content, filename, label_prefix=label_prefix, progress=progress)
        try:
            require_shallow_expressions(document.triples)
        except ValueError as error:
            raise errors.BadFile(
                f"{filename or 'the document'}: {error}; define a class for inner ones"
            ) from None
        return document

    def close_tbox(self, triples: Iterable[Triple], filename: str) -> Facts | None:
        """Return the closure of a TBox for `Reasoner`, or None if it is inconsistent or has none.

        Raises BadFile if that exceeds a limit. Any thread may call this.
        """
        with self._turn:
            packed = self._exchange(ClosureRequest(list(triples)), ClosureReply, filename).packed
            if len(packed) > _LARGE:
                self._discard()
        return unpack(packed) if packed else None

    def _exchange(self, request: Request | ClosureRequest, kind: type[R], filename: str) -> R:
        process, connection = self._started()
        try:
            connection.send_bytes(msgpack.encode(request))
            if connection.poll(self._wall_s):
                return msgpack.decode(connection.recv_bytes(), type=kind)
            status: int = -signal.SIGXCPU
        except (EOFError, OSError):
            with suppress(subprocess.TimeoutExpired):
                process.wait(_END_S)
            process.kill()
            status = process.wait()
        self._discard()
        raise errors.BadFile(f"{filename or 'the document'} {_describe(status)}")

    def _started(self) -> tuple[subprocess.Popen[bytes], Connection]:
        if self._process is None or self._connection is None or self._process.poll() is not None:
            self._discard()
            try:
                self._connection, remote = Pipe()
                with remote:
                    self._process = subprocess.Popen(
                        [*self._command, str(remote.fileno())],
                        pass_fds=[remote.fileno()],
                        stdin=subprocess.DEVNULL,
                    )
            except OSError as error:
                raise errors.Refused(f"the parser does not start: {error.strerror}; try again") from None
        return self._process, self._connection

    def close(self) -> None:
        """Stop the process. A document that it parses is rejected."""
        if (process := self._process) is not None:
            process.kill()
        with self._turn:
            self._discard()

    def _discard(self) -> None:
        if self._process is not None:
            self._process.kill()
            self._process.wait()
        if self._connection is not None:
            self._connection.close()
        self._process = self._connection = None


def _describe(status: int) -> str:
    """Return what a document did to its process, and the next step."""
    if status == -signal.SIGXCPU:
        return f"takes longer than {CPU_S:g} s to read; split it, or save it as Turtle"
    if status in (OUT_OF_MEMORY, -signal.SIGABRT, -signal.SIGKILL):
        return f"needs more than {MEMORY_BYTES >> 20} MB of memory to read; split it, or save it as Turtle"
    return f"cannot be read: it ended the parser (status {status}); save it with another program, as Turtle"
