"""The process that parses documents and URDF, writes OWL and closes TBoxes, within limits of memory and time.

`isolated_parser.py` starts it.
"""

from __future__ import annotations

from array import array

from msgspec import Struct, msgpack

from semmap.nodes.kb_node.documents import owl_export, rdf, urdf
from semmap.nodes.kb_node.documents.owl_export import OwlDocument, OwlFormat
from semmap.nodes.kb_node.reasoner import Inconsistent, Reasoner
from semmap.nodes.kb_node.reasoner.explanations import Explanation
from semmap.nodes.kb_node.reasoner.rules.facts import pack
from semmap.nodes.runtime.isolated_process import serve
from semmap.schemas import errors
from semmap.schemas.explanations import Triple


class Request(Struct, frozen=True, tag=True):
    """A document to parse; see `rdf.read`."""

    content: bytes
    filename: str
    label_prefix: str
    graph: str = ""


class Reply(Struct, frozen=True, tag=True):
    """The parsed document, or the error text of a document that is not valid."""

    error: str = ""
    prefixes: dict[str, str] = {}
    terms: tuple[str, ...] = ()
    """The distinct terms."""
    triples: bytes = b""
    """Three indices of terms for each triple, as unsigned 32-bit integers."""
    notes: tuple[str, ...] = ()

    @classmethod
    def of(cls, document: rdf.Document) -> Reply:
        """Return the reply with this document."""
        numbers: dict[str, int] = {}
        number = numbers.setdefault
        triples = array("I", (number(term, len(numbers)) for triple in document.triples for term in triple))
        return cls(
            prefixes=document.prefixes,
            terms=tuple(numbers),
            triples=triples.tobytes(),
            notes=document.notes,
        )

    def document(self) -> rdf.Document:
        """Return the document. Equal terms are the same object. Raises BadFile with the error text."""
        if self.error:
            raise errors.BadFile(self.error)
        terms = map(self.terms.__getitem__, memoryview(self.triples).cast("I"))
        return rdf.Document(list(zip(terms, terms, terms, strict=True)), self.prefixes, self.notes)


class UrdfRequest(Struct, frozen=True, tag=True):
    """A URDF file to parse; see `urdf.read`."""

    content: bytes
    filename: str


class UrdfReply(Struct, frozen=True, tag=True):
    """The links of a URDF file, or the error text of a file that is not valid."""

    error: str = ""
    links: dict[str, urdf.Link] = {}


class OwlRequest(Struct, frozen=True, tag=True):
    """Triples to write in a syntax of OWL; see `owl_export.write`."""

    triples: list[Triple]
    syntax: OwlFormat
    prefixes: dict[str, str]


class OwlReply(Struct, frozen=True, tag=True):
    """The document and notes on it, or the error text of triples that cannot be written."""

    error: str = ""
    document: OwlDocument = OwlDocument(b"")


class ClosureRequest(Struct, frozen=True, tag=True):
    """The triples of a TBox whose closure is to be computed."""

    triples: list[Triple]


class ClosureReply(Struct, frozen=True, tag=True):
    """The closure, packed; b"" if it is not computed separately, or if the TBox is inconsistent."""

    packed: bytes = b""
    clash: Explanation | None = None
    """Why the TBox is inconsistent."""


def answer(content: bytes) -> bytes:
    """Return the encoded reply to an encoded request."""
    request = msgpack.decode(content, type=Request | UrdfRequest | OwlRequest | ClosureRequest)
    if isinstance(request, Request):
        return msgpack.encode(_parse(request))
    if isinstance(request, UrdfRequest):
        return msgpack.encode(_parse_urdf(request))
    return msgpack.encode(_write(request) if isinstance(request, OwlRequest) else _close(request))


def _parse(request: Request) -> Reply:
    try:
        document = rdf.read(
            request.content, request.filename, label_prefix=request.label_prefix, graph=request.graph
        )
        return Reply.of(document)
    except errors.BadFile as error:
        return Reply(error=error.text)


def _parse_urdf(request: UrdfRequest) -> UrdfReply:
    try:
        return UrdfReply(links=urdf.read(request.content, request.filename))
    except errors.BadFile as error:
        return UrdfReply(error=error.text)


def _write(request: OwlRequest) -> OwlReply:
    try:
        written = owl_export.write(request.triples, request.syntax, request.prefixes)
    except errors.Refused as error:
        return OwlReply(error=error.text)
    return OwlReply(document=written)


def _close(request: ClosureRequest) -> ClosureReply:
    try:
        closed = Reasoner(request.triples).closed
    except Inconsistent as error:
        return ClosureReply(clash=error.explanation)
    return ClosureReply() if closed is None else ClosureReply(pack(closed))


if __name__ == "__main__":
    serve(answer)
