"""RDF documents in and out, in every syntax; terms are strings in N-Triples form.

Reading is Oxigraph's: strict, fast, and never on the network. Writing is rdflib's, for its prefixes and
readable layout.
"""

from __future__ import annotations

from collections.abc import Iterable

import pyoxigraph
import rdflib

from ontology import vocabulary as v
from schemas import errors
from schemas.commands import RdfFormat
from schemas.explanations import Triple

_READ = {
    "rdfxml": pyoxigraph.RdfFormat.RDF_XML,
    "turtle": pyoxigraph.RdfFormat.TURTLE,
    "ntriples": pyoxigraph.RdfFormat.N_TRIPLES,
    "jsonld": pyoxigraph.RdfFormat.JSON_LD,
}
_WRITE = {"rdfxml": "pretty-xml", "turtle": "longturtle", "ntriples": "nt", "jsonld": "json-ld"}
MEDIA_TYPES: dict[str, str] = {
    "rdfxml": "application/rdf+xml",
    "turtle": "text/turtle",
    "ntriples": "application/n-triples",
    "jsonld": "application/ld+json",
}


def syntax_of(content: bytes) -> RdfFormat:
    """The syntax that `content` begins like: XML, JSON, or else Turtle (of which N-Triples is a part)."""
    start = content.lstrip(b"\xef\xbb\xbf \t\r\n")[:1]
    if start in (b"{", b"["):
        return "jsonld"
    if start == b"<" and _is_xml(content):
        return "rdfxml"
    return "turtle"


def _is_xml(content: bytes) -> bool:
    head = content.lstrip(b"\xef\xbb\xbf \t\r\n")[:4096]
    return head.startswith((b"<?xml", b"<!")) or b"<rdf:RDF" in head or b"xmlns" in head


def parse(content: bytes, filename: str, *, label_prefix: str = "") -> list[Triple]:
    """The triples of a document. Blank nodes get `label_prefix`, so that those of two files do not meet.

    Raises BadFile with the place of the fault.
    """
    syntax = syntax_of(content)
    try:
        quads = list(pyoxigraph.parse(content, _READ[syntax], base_iri=v.ABOX, without_named_graphs=True))
    except (SyntaxError, ValueError) as error:
        raise errors.BadFile(f"{filename or 'the document'} is no valid {_spoken(syntax)}: {error}") from None
    return [
        (_term(quad.subject, label_prefix), str(quad.predicate), _term(quad.object, label_prefix))
        for quad in quads
    ]


def _term(term: object, label_prefix: str) -> str:
    if isinstance(term, pyoxigraph.BlankNode):
        return f"_:{label_prefix}{term.value}"
    return str(term)


def _spoken(syntax: str) -> str:
    return {"rdfxml": "RDF/XML", "turtle": "Turtle", "ntriples": "N-Triples", "jsonld": "JSON-LD"}[syntax]


def serialise(triples: Iterable[Triple], syntax: RdfFormat) -> bytes:
    """A document in which `triples` are sorted and prefixed."""
    lines = sorted(f"{s} {p} {o} .\n" for s, p, o in triples)
    if syntax == "ntriples":
        return "".join(lines).encode()
    graph = rdflib.Graph()
    graph.parse(data="".join(lines), format="nt")
    for prefix, namespace in v.PREFIXES.items():
        graph.bind(prefix, namespace, replace=True)
    return graph.serialize(format=_WRITE[syntax], encoding="utf-8")
