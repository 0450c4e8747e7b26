"""Import and export in all RDF syntaxes, and import in OWL syntaxes. Terms are strings in N-Triples form.

Oxigraph reads and writes RDF: strictly, fast, without network access, and without changing literals. Large
Turtle files are read faster with the same result (`plain_turtle.py`). The OWL syntaxes are only read
(`owl/`).
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterable
from contextlib import suppress
from types import MappingProxyType
from typing import NamedTuple

import pyoxigraph

from semmap.nodes.kb_node.documents import plain_turtle
from semmap.nodes.kb_node.documents.error_lines import find_error_line
from semmap.nodes.kb_node.documents.owl import syntaxes as owl_syntaxes
from semmap.nodes.kb_node.documents.owl.syntaxes import OwlSyntax
from semmap.ontology import vocabulary as v
from semmap.ontology.prefixes import Prefixes
from semmap.schemas import errors
from semmap.schemas.commands import RdfFormat
from semmap.schemas.explanations import Triple
from semmap.schemas.nesting import require_shallow, require_shallow_xml

_SYNTAX = {
    "rdfxml": pyoxigraph.RdfFormat.RDF_XML,
    "turtle": pyoxigraph.RdfFormat.TURTLE,
    "ntriples": pyoxigraph.RdfFormat.N_TRIPLES,
    "jsonld": pyoxigraph.RdfFormat.JSON_LD,
}
_SYNTAX_NAMES: dict[RdfFormat | OwlSyntax, str] = {
    "rdfxml": "RDF/XML",
    "turtle": "Turtle",
    "ntriples": "N-Triples",
    "jsonld": "JSON-LD",
    "functional": "OWL functional syntax",
    "manchester": "Manchester syntax",
    "owlxml": "OWL/XML",
}
MEDIA_TYPES: dict[str, str] = {
    "rdfxml": "application/rdf+xml",
    "turtle": "text/turtle",
    "ntriples": "application/n-triples",
    "jsonld": "application/ld+json",
}
_PROGRESS_EVERY = 50_000
_LARGE = 1 << 20
"""Bytes from which it is worth trying the fast reader."""
_BOM = b"\xef\xbb\xbf"
_XML = re.compile(rb"\s*<(\?xml|!DOCTYPE|!--|[\w.:-]+\s[^>]*\bxmlns)")
_JSON = re.compile(rb"\s*(\{|\[\s*(\{|\]\s*\Z))")
_LINE = re.compile(r"\bline \d")
_NOT_XML = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\ufffe\uffff]")


_BUFFER_ERROR = "buffer maximal size"
"""The text of pyoxigraph's MemoryError for a term that does not fit into its buffer."""


class Document(NamedTuple):
    """The content of a document."""

    triples: list[Triple]
    prefixes: dict[str, str]
    """Those that are declared before the first triple, with their namespaces."""


def syntax_of(content: bytes) -> RdfFormat | OwlSyntax:
    """Return the syntax that `content` begins like; Turtle, which includes N-Triples, by default."""
    if _XML.match(content):
        return "owlxml" if owl_syntaxes.is_owl_xml(content) else "rdfxml"
    return "jsonld" if _JSON.match(content) else owl_syntaxes.owl_syntax_of(content) or "turtle"


def parse(content: bytes, filename: str, *, label_prefix: str = "") -> list[Triple]:
    """Return the triples of a document, like `read`."""
    return read(content, filename, label_prefix=label_prefix).triples


def read(
    content: bytes, filename: str, *, label_prefix: str = "", progress: Callable[[int], None] = lambda _: None
) -> Document:
    """Read a document. Blank nodes get `label_prefix`, so that those of two files differ.

    `progress` receives the number of triples now and then. Raises BadFile with the position of the error.
    """
    name = filename or "the document"
    content = content.removeprefix(_BOM)
    if not content or content.isspace():
        raise errors.BadFile(f"{name} is empty")
    try:
        content.decode()
    except UnicodeDecodeError as error:
        where = content.count(b"\n", 0, error.start) + 1
        raise errors.BadFile(f"{name} is not UTF-8 text (line {where}); save it as UTF-8") from None
    syntax = syntax_of(content)
    try:
        _require_shallow(content, syntax)
        if syntax == "functional" or syntax == "manchester" or syntax == "owlxml":
            text = content.decode()
            triples = [_labelled(triple, label_prefix) for triple in owl_syntaxes.parse(text, syntax)]
            return Document(triples, owl_syntaxes.prefixes(text, syntax))
        declared = _declared_prefixes(content, syntax)
        if syntax == "turtle" and len(content) >= _LARGE:
            plain = plain_turtle.read(content, declared, label_prefix, progress)
            if plain is not None:
                return Document(plain, declared)
        quads = pyoxigraph.parse(content, _SYNTAX[syntax], base_iri=v.ABOX, without_named_graphs=True)
        return Document(_triples(quads, label_prefix, progress), declared)
    except (SyntaxError, ValueError) as error:
        reason = _reason(error)
        if syntax in ("rdfxml", "jsonld") and isinstance(error, SyntaxError) and not _LINE.search(reason):
            line = find_error_line(content, _SYNTAX[syntax], v.ABOX)
            reason += f" (line {line})" if syntax == "rdfxml" else f" (at or before line {line})"
        raise errors.BadFile(f"{name} is not valid {_SYNTAX_NAMES[syntax]}: {reason}") from None
    except MemoryError as error:
        if _BUFFER_ERROR not in str(error):
            raise
        raise errors.BadFile(
            f"{name} is not valid {_SYNTAX_NAMES[syntax]}: it has a word or a text of more than 16 MB"
        ) from None


def _triples(
    quads: Iterable[pyoxigraph.Quad], label_prefix: str, progress: Callable[[int], None]
) -> list[Triple]:
    """Return the triples as text. Equal terms are the same object, which limits the memory of large files.

    Formatting a whole quad takes half the time of formatting its terms.
    """
    terms: dict[str, str] = {}
    shared = terms.setdefault
    triples: list[Triple] = []
    add, before = triples.append, ""
    for quad in quads:
        s, p, o = str(quad).split(" ", 2)
        if s == before:
            s = before
        else:
            if s[0] != "<":
                s = _label(s, label_prefix)
            before = s = shared(s, s)
        if o[0] == "_" or o[:2] == "<<":
            o = _label(o, label_prefix)
        add((s, shared(p, p), shared(o, o)))
        if len(triples) % _PROGRESS_EVERY == 0:
            progress(len(triples))
    return triples


def _label(term: str, label_prefix: str) -> str:
    """Return a blank node with its prefix."""
    if not term.startswith("_:"):
        raise ValueError("it makes a statement about a triple, which OWL cannot express")
    return f"_:{label_prefix}{term[2:]}"


def _labelled(triple: Triple, label_prefix: str) -> Triple:
    s, p, o = (f"_:{label_prefix}{t[2:]}" if t.startswith("_:") else t for t in triple)
    return s, p, o


def _reason(error: Exception) -> str:
    if "LoadDocumentCallback" in str(error):
        return (
            "its @context is remote, and nothing is fetched from the network; include the context in the file"
        )
    return str(error).replace("\n", " ")


def _require_shallow(content: bytes, syntax: RdfFormat | OwlSyntax) -> None:
    """Raise ValueError for a document that is nested too deeply, and for XML that is not well-formed.

    Oxigraph accepts XML that ends within an element, and expands entities without limit.
    """
    if syntax in ("rdfxml", "owlxml"):
        require_shallow_xml(content)
    else:
        require_shallow(content, {"ntriples": "turtle", "jsonld": "json"}.get(syntax, syntax))


def _declared_prefixes(content: bytes, syntax: RdfFormat) -> dict[str, str]:
    quads = pyoxigraph.parse(content, _SYNTAX[syntax], base_iri=v.ABOX, without_named_graphs=True)
    with suppress(SyntaxError, ValueError):
        next(quads, None)
    return dict(quads.prefixes)


def serialise(
    triples: Iterable[Triple], syntax: RdfFormat, prefixes: Prefixes = MappingProxyType(v.PREFIXES)
) -> bytes:
    """Return a document with sorted and prefixed triples, which `parse` reads back unchanged.

    Raises Refused for a text that the syntax cannot express.
    """
    lines = "".join(sorted(f"{s} {p} {o} .\n" for s, p, o in triples)).encode()
    if syntax == "ntriples":
        return lines
    quads = pyoxigraph.parse(lines, pyoxigraph.RdfFormat.N_TRIPLES)
    document = pyoxigraph.serialize(quads, format=_SYNTAX[syntax], prefixes=dict(prefixes))
    if document is None:
        raise errors.InternalError("the triples were not serialized")
    if syntax == "jsonld":
        return json.dumps(json.loads(document), indent=1, ensure_ascii=False).encode()
    return _as_xml(document) if syntax == "rdfxml" else document


def _as_xml(document: bytes) -> bytes:
    """Escape line ends, which XML readers change. Raises Refused for control characters."""
    if found := _NOT_XML.search(document.decode()):
        raise errors.Refused(f"RDF/XML cannot hold the character {found[0]!r}; export as Turtle instead")
    return document.replace(b"\r", b"&#13;")
