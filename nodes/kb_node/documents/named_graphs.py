"""The graphs of a document: which one is loaded, and how many statements the others have.

The map is one graph. TriG, N-Quads and JSON-LD documents may have several, of which one is loaded.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from typing import Final

import pyoxigraph

from semmap.schemas import wording

_FEW: Final = 5
_DEFAULT: Final = pyoxigraph.DefaultGraph()
_IRI: Final = rb"<[^<>\"{}|^`\\\x00-\x20]*+>"
_BLANK: Final = rb"_:[^\s<>\"]++"
_LITERAL: Final = rb'"(?:[^"\\\n\r]++|\\.)*+"(?:@[A-Za-z0-9-]++|\^\^' + _IRI + rb")?"
_LINE: Final = re.compile(
    rb"\s*+(?:%(i)b|%(b)b)\s*+%(i)b\s*+(?:%(i)b|%(b)b|%(l)b)\s*+(%(i)b|%(b)b)?+\s*+\.\s*+(?:#|\Z)"
    % {b"i": _IRI, b"b": _BLANK, b"l": _LITERAL}
)
"""A statement of N-Triples, or of N-Quads with its graph as the group."""
_ATOMS: Final = re.compile(
    rb"(?:[^\"'#<{]++|<[^<>\s{]*+>|<|#[^\n]*+"
    rb'|"""(?:[^"\\]++|\\.|"(?!""))*+(?:"""|\Z)|"(?:[^"\\\n]++|\\.)*+"?'
    rb"|'''(?:[^'\\]++|\\.|'(?!''))*+(?:'''|\Z)|'(?:[^'\\\n]++|\\.)*+'?)*+",
    re.DOTALL,
)
"""Turtle up to the first brace outside of texts, IRIs and comments."""
_SAMPLE: Final = 1 << 16
"""Bytes at the beginning and at the end that are searched for a quad."""

Graph = pyoxigraph.NamedNode | pyoxigraph.BlankNode | pyoxigraph.DefaultGraph | pyoxigraph.Triple


def has_braces(content: bytes) -> bool:
    """Return whether a document like Turtle has a brace, as TriG has around the statements of a graph."""
    if b"{" not in content:
        return False
    end = _ATOMS.match(content)
    return end is not None and content[end.end() : end.end() + 1] == b"{"


def has_quads(content: bytes) -> bool:
    """Return whether a document is N-Quads with a graph near the beginning or the end."""
    lines = content[:_SAMPLE].splitlines()
    if len(content) > _SAMPLE:
        lines = [*lines[:-1], *content[-_SAMPLE:].splitlines()[1:]]
    statements = [line for line in lines if line.strip() and not line.lstrip().startswith(b"#")]
    if not statements or not _LINE.match(statements[0]):
        return False  # Turtle, which may have such a line within a text
    return any((found := _LINE.match(line)) and found[1] for line in statements)


def count_statements(quads: Iterable[pyoxigraph.Quad]) -> Counter[Graph]:
    """Return the number of statements of each graph."""
    return Counter(quad.graph_name for quad in quads)


def choose_graph(counts: Mapping[Graph, int], wanted: str, prefixes: Mapping[str, str]) -> Graph:
    """Return the graph with this name, or the default graph for "".

    A name is an IRI, also in `<>`, with a prefix of the document, or the last part of an IRI. Raises
    ValueError for an unknown or ambiguous name, and for an empty default graph beside named ones.
    """
    named = {graph: name for graph in counts if (name := _iri(graph))}
    if not wanted:
        if counts and _DEFAULT not in counts:
            raise ValueError(
                f"its default graph is empty; it has {_describe(counts, 'in named graphs')};"
                " to load one of them use semmap load --graph NAME"
            )
        return _DEFAULT
    prefix, _, local = wanted.partition(":")
    exact = {wanted.removeprefix("<").removesuffix(">"), prefixes.get(prefix, "\0") + local}
    found = [graph for graph, name in named.items() if name in exact]
    found = found or [graph for graph, name in named.items() if _last_part(name) == wanted]
    if len(found) == 1:
        return found[0]
    if found:
        raise ValueError(f"'{wanted}' is ambiguous: {_few([f'<{named[graph]}>' for graph in found])}")
    there = f"it has {_describe(counts, 'in its graphs')}" if named else "it has no named graphs"
    raise ValueError(f"there is no graph '{wanted}'; {there}")


def select(quads: Iterable[pyoxigraph.Quad], graph: Graph) -> Iterator[pyoxigraph.Quad]:
    """Yield the statements of one graph as statements of the default graph."""
    for quad in quads:
        if quad.graph_name == graph:
            yield pyoxigraph.Quad(quad.subject, quad.predicate, quad.object)


def left_out_note(counts: Mapping[Graph, int], chosen: Graph) -> str:
    """Return a note on the statements of the other graphs, or ""."""
    others = {graph: count for graph, count in counts.items() if graph != chosen}
    if not others:
        return ""
    option = "; to load such a graph use --graph NAME" if any(map(_iri, others)) else ""
    return f"left out: {_describe(others, 'in other graphs')}{option}"


def _describe(counts: Mapping[Graph, int], where: str) -> str:
    """Return the number of statements, and those of each graph."""
    texts = [f"{_called(graph)}: {count}" for graph, count in sorted(counts.items(), key=lambda g: str(g[0]))]
    return f"{wording.counted(sum(counts.values()), 'statement')} {where} ({_few(texts)})"


def _few(texts: list[str]) -> str:
    return wording.few(texts, _FEW)


def _called(graph: Graph) -> str:
    if name := _iri(graph):
        return _last_part(name) or f"<{name}>"
    return "the default graph" if graph == _DEFAULT else "a blank node"


def _iri(graph: Graph) -> str:
    return graph.value if isinstance(graph, pyoxigraph.NamedNode) else ""


def _last_part(iri: str) -> str:
    return re.split(r"[#/:]", iri)[-1]
