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
from typing import Literal, NamedTuple

import pyoxigraph

from semmap.nodes.kb_node.documents import named_graphs, plain_turtle, text_encoding, xml_base
from semmap.nodes.kb_node.documents.error_lines import find_error_line
from semmap.nodes.kb_node.documents.owl import syntaxes as owl_syntaxes
from semmap.nodes.kb_node.documents.owl.syntaxes import OwlSyntax
from semmap.ontology import vocabulary as v
from semmap.ontology.prefixes import Prefixes
from semmap.schemas import errors
from semmap.schemas.commands import RdfFormat
from semmap.schemas.explanations import Triple
from semmap.schemas.nesting import require_shallow, require_shallow_xml

_Syntax = RdfFormat | OwlSyntax | Literal["trig", "nquads"]
_SYNTAX: dict[_Syntax, pyoxigraph.RdfFormat] = {
    "rdfxml": pyoxigraph.RdfFormat.RDF_XML,
    "turtle": pyoxigraph.RdfFormat.TURTLE,
    "ntriples": pyoxigraph.RdfFormat.N_TRIPLES,
    "jsonld": pyoxigraph.RdfFormat.JSON_LD,
    "trig": pyoxigraph.RdfFormat.TRIG,
    "nquads": pyoxigraph.RdfFormat.N_QUADS,
}
_WITH_GRAPHS = ("trig", "nquads", "jsonld")
_SYNTAX_NAMES: dict[_Syntax, str] = {
    "rdfxml": "RDF/XML",
    "turtle": "Turtle",
    "ntriples": "N-Triples",
    "jsonld": "JSON-LD",
    "trig": "TriG",
    "nquads": "N-Quads",
    "functional": "OWL functional syntax",
    "manchester": "Manchester syntax",
    "owlxml": "OWL/XML",
}
MEDIA_TYPES: dict[RdfFormat, str] = {
    "rdfxml": "application/rdf+xml",
    "turtle": "text/turtle",
    "ntriples": "application/n-triples",
    "jsonld": "application/ld+json",
    "functional": "text/owl-functional",
    "manchester": "text/owl-manchester",
}
_PROGRESS_EVERY = 50_000
_LARGE = 1 << 20
"""Bytes from which it is worth trying the fast reader."""
_XML = re.compile(rb"\s*<(\?xml|!DOCTYPE|!--|[\w.:-]+\s[^>]*\bxmlns)")
_JSON = re.compile(rb"\s*(\{(?!\s*([<#\[(]|_:|\w*:\w))|\[\s*(\{|\]\s*\Z))")
"""A brace is also the beginning of TriG, but JSON continues with a text."""
_LINE = re.compile(r"\bline \d")
_NOT_XML = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\ufffe\uffff]")


_BUFFER_ERROR = "buffer maximal size"
"""The text of pyoxigraph's MemoryError for a term that does not fit into its buffer."""


class Document(NamedTuple):
    """The content of a document."""

    triples: list[Triple]
    prefixes: dict[str, str]
    """Those that are declared before the first triple, with their namespaces."""
    notes: tuple[str, ...] = ()
    """Notes on statements that are left out."""


def syntax_of(content: bytes) -> _Syntax:
    """Return the syntax of UTF-8 text; Turtle, which includes N-Triples, by default."""
    if _XML.match(content):
        return "owlxml" if owl_syntaxes.is_owl_xml(content) else "rdfxml"
    if _JSON.match(content):
        return "jsonld"
    if (syntax := owl_syntaxes.owl_syntax_of(content)) is not None:
        return syntax
    if named_graphs.has_braces(content):
        return "trig"
    return "nquads" if named_graphs.has_quads(content) else "turtle"


def parse(content: bytes, filename: str, *, label_prefix: str = "") -> list[Triple]:
    """Return the triples of a document, like `read`."""
    return read(content, filename, label_prefix=label_prefix).triples


def read(
    content: bytes,
    filename: str,
    *,
    label_prefix: str = "",
    graph: str = "",
    progress: Callable[[int], None] = lambda _: None,
) -> Document:
    """Read a document. Blank nodes get `label_prefix`, so that those of two files differ.

    `graph` is the named graph to read in place of the default graph; see `named_graphs.choose_graph`.
    `progress` receives the number of triples now and then. Raises BadFile with the position of the error.
    """
    name = filename or "the document"
    try:
        content = text_encoding.to_utf8(content)
    except ValueError as error:
        raise errors.BadFile(f"{name}: {error}") from None
    if not content or content.isspace():
        raise errors.BadFile(f"{name} is empty")
    syntax = syntax_of(content)
    if graph and syntax not in _WITH_GRAPHS:
        raise errors.BadFile(
            f"{name} is {_SYNTAX_NAMES[syntax]}, which has no graphs; load it without --graph"
        )
    try:
        _require_shallow(content, syntax)
        if syntax in ("rdfxml", "owlxml"):
            content = xml_base.resolve_bases(content, v.ABOX)
        if syntax == "functional" or syntax == "manchester" or syntax == "owlxml":
            text = content.decode()
            triples = [_labelled(triple, label_prefix) for triple in owl_syntaxes.parse(text, syntax)]
            return Document(triples, owl_syntaxes.prefixes(text, syntax))
        if syntax in _WITH_GRAPHS:
            return _read_graph(content, syntax, name, graph, label_prefix, progress)
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


def _read_graph(
    content: bytes,
    syntax: _Syntax,
    name: str,
    graph: str,
    label_prefix: str,
    progress: Callable[[int], None],
) -> Document:
    """Read one graph of a document that may have several, in two passes: the second needs the names."""
    quads = pyoxigraph.parse(content, _SYNTAX[syntax], base_iri=v.ABOX)
    counts = named_graphs.count_statements(quads)
    prefixes = dict(quads.prefixes)
    try:
        chosen = named_graphs.choose_graph(counts, graph, prefixes)
    except ValueError as error:
        raise errors.BadFile(f"{name}: {error}") from None
    again = pyoxigraph.parse(content, _SYNTAX[syntax], base_iri=v.ABOX)
    note = named_graphs.left_out_note(counts, chosen)
    triples = _triples(named_graphs.select(again, chosen), label_prefix, progress)
    return Document(triples, prefixes, (note,) if note else ())


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


_REPEATED_LINE = re.compile(r"^(line (\d+) .*) \(line \2\)$")
"""A reason of Oxigraph that begins with the line which Python adds at its end."""


def _reason(error: Exception) -> str:
    if "LoadDocumentCallback" in str(error):
        return (
            "its @context is remote, and nothing is fetched from the network; include the context in the file"
        )
    reason = str(error).replace("\n", " ").removeprefix("Parser error at ")
    return _REPEATED_LINE.sub(r"\1", reason)


def _require_shallow(content: bytes, syntax: _Syntax) -> None:
    """Raise ValueError for a document that is nested too deeply, and for XML that is not well-formed.

    Oxigraph accepts XML that ends within an element, and expands entities without limit.
    """
    if syntax in ("rdfxml", "owlxml"):
        require_shallow_xml(content)
    else:
        of_turtle = dict.fromkeys(("ntriples", "trig", "nquads"), "turtle")
        require_shallow(content, {**of_turtle, "jsonld": "json"}.get(syntax, syntax))


def _declared_prefixes(content: bytes, syntax: _Syntax) -> dict[str, str]:
    quads = pyoxigraph.parse(content, _SYNTAX[syntax], base_iri=v.ABOX, without_named_graphs=True)
    with suppress(SyntaxError, ValueError):
        next(quads, None)
    return dict(quads.prefixes)


def serialise(
    triples: Iterable[Triple], syntax: RdfFormat, prefixes: Prefixes = MappingProxyType(v.PREFIXES)
) -> bytes:
    """Return a document in an RDF syntax, sorted and with prefixes, which `parse` reads back unchanged.

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
