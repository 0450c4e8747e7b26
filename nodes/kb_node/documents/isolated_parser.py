"""Parses documents of unknown origin in a separate process, which may fail without harm.

Turtle and N-Triples are the exception. They are read as a stream, without recursion over what
`schemas/nesting.py` limits, and the result of a large file would take longer to transfer than to parse. All
other syntaxes have native parsers that build the whole document in memory.
"""

from __future__ import annotations

import codecs
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Final

from msgspec import msgpack

from semmap.nodes.kb_node import proofs
from semmap.nodes.kb_node.documents import rdf, text_encoding
from semmap.nodes.kb_node.documents.blank_nodes import require_shallow_expressions
from semmap.nodes.kb_node.documents.owl_export import OwlDocument, OwlFormat
from semmap.nodes.kb_node.documents.parser_process import (
    ClosureReply,
    ClosureRequest,
    OwlReply,
    OwlRequest,
    Reply,
    Request,
    UrdfReply,
    UrdfRequest,
)
from semmap.nodes.kb_node.documents.urdf import Link
from semmap.nodes.kb_node.reasoner import Inconsistent
from semmap.nodes.kb_node.reasoner.rules.facts import Facts, unpack
from semmap.nodes.runtime.isolated_process import IsolatedProcess, program
from semmap.schemas import errors
from semmap.schemas.explanations import Triple

_PROGRAM: Final = program("semmap.nodes.kb_node.documents.parser_process")


class IsolatedParser(IsolatedProcess):
    """Parses one document at a time, or closes one TBox. The process starts with the first that needs it."""

    remedy = "split it, or save it as Turtle"
    repair = "save it with another program, as Turtle"

    def __init__(self, command: Sequence[str] = _PROGRAM) -> None:
        """Create it; `command` is the program of the process."""
        super().__init__(command)

    @staticmethod
    def isolates(content: bytes) -> bool:
        """Return whether a document is parsed in the process."""
        text = content.removeprefix(codecs.BOM_UTF8)
        return text_encoding.is_wide(content) or rdf.syntax_of(text) != "turtle"

    def read(
        self,
        content: bytes,
        filename: str,
        label_prefix: str = "",
        progress: Callable[[int], None] = lambda _: None,
        *,
        graph: str = "",
    ) -> rdf.Document:
        """Read a document like `rdf.read`. Any thread may call this.

        Raises BadFile also for a document that ends its process or exceeds a limit, and for class expressions
        that are nested too deeply. `progress` is called only for documents that are not isolated.
        """
        if self.isolates(content):
            request = msgpack.encode(Request(content, filename, label_prefix, graph))
            reply = self.exchange(request, filename or "the document")
            document = msgpack.decode(reply, type=Reply).document()
        else:
            document = rdf.read(content, filename, label_prefix=label_prefix, graph=graph, progress=progress)
        try:
            require_shallow_expressions(document.triples)
        except ValueError as error:
            raise errors.BadFile(
                f"{filename or 'the document'}: {error}; define a class for inner ones"
            ) from None
        return document

    def read_urdf(self, content: bytes, filename: str) -> dict[str, Link]:
        """Return the links of a URDF file like `urdf.read`. Any thread may call this.

        Raises BadFile also for a file that ends its process or exceeds a limit.
        """
        request = msgpack.encode(UrdfRequest(content, filename))
        reply = msgpack.decode(self.exchange(request, filename), type=UrdfReply)
        if reply.error:
            raise errors.BadFile(reply.error)
        return reply.links

    def write_owl(
        self, triples: Iterable[Triple], syntax: OwlFormat, prefixes: Mapping[str, str]
    ) -> OwlDocument:
        """Return an ontology like `owl_export.write`. Any thread may call this.

        Raises Refused for triples that cannot be written, and BadFile if that exceeds a limit.
        """
        request = msgpack.encode(OwlRequest(list(triples), syntax, dict(prefixes)))
        reply = msgpack.decode(self.exchange(request, "the export"), type=OwlReply)
        if reply.error:
            raise errors.Refused(reply.error)
        return reply.document

    def close_tbox(
        self, triples: Iterable[Triple], filename: str, *, of: str = "", wall_s: float | None = None
    ) -> Facts | None:
        """Return the closure of a TBox for `Reasoner`, or None if it is not computed separately.

        Raises Inconsistent, with a text that begins with `of`, and BadFile if the closure exceeds a limit.
        `wall_s` is another limit of time. Any thread may call this.
        """
        request = msgpack.encode(ClosureRequest(list(triples)))
        content = self.exchange(request, filename or "the document", wall_s=wall_s)
        reply = msgpack.decode(content, type=ClosureReply)
        if reply.clash is not None:
            raise proofs.to_error(Inconsistent(reply.clash), of=of)
        return unpack(reply.packed) if reply.packed else None
