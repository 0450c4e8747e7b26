"""Which commits may change the rows of a query: a sound over-estimate from its triple patterns."""

from __future__ import annotations

import logging
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from rdflib import BNode, URIRef, Variable
from rdflib.paths import AlternativePath, InvPath, MulPath, Path, SequencePath
from rdflib.plugins.sparql import prepareQuery
from rdflib.plugins.sparql.parserutils import CompValue

from semmap.nodes.kb_node.sparql.queries.text import PREFIXES
from semmap.ontology import vocabulary as v
from semmap.schemas.explanations import Term, Triple

logging.getLogger("rdflib").setLevel(logging.ERROR)


Pattern = tuple[Term | None, Term | None, Term | None]


class _Anything(Exception):
    """Raised if any triple may matter."""


@dataclass(frozen=True)
class Footprint:
    """The predicates and classes that a query reads; None stands for all of them."""

    predicates: frozenset[Term] | None = None
    classes: frozenset[Term] | None = None

    def is_touched(self, changed: Iterable[Triple]) -> bool:
        """Return whether rows may change when these triples are added or removed."""
        return any(self._looks_at(p, o) for _, p, o in changed)

    def _looks_at(self, p: Term, o: Term) -> bool:
        if self.predicates is None or p in self.predicates:
            return True
        return p == v.RDF_TYPE and (self.classes is None or o in self.classes)


def footprint(query: str) -> Footprint:
    """Return what a query reads: everything, if its patterns are unknown.

    `owl:` and other prefixes are those of `text.PREFIXES`. A type pattern with a class counts for that class
    only. A path that may have no steps relates every term to itself, so any triple matters to it.
    """
    patterns = patterns_of(query)
    if patterns is None or any(p is None for _, p, _ in patterns):
        return Footprint()
    predicates = frozenset(p for _, p, _ in patterns if p is not None and p != v.RDF_TYPE)
    classes = [o for _, p, o in patterns if p == v.RDF_TYPE]
    return Footprint(predicates, None if None in classes else frozenset(filter(None, classes)))


@lru_cache(maxsize=1000)
def patterns_of(query: str, prefixes: tuple[tuple[str, str], ...] = ()) -> frozenset[Pattern] | None:
    """Return the triple patterns of a query, with None for any term, or None if they are unknown.

    A described resource counts as the subject and as the object of any triple. `prefixes` are known in
    addition to `text.PREFIXES`.
    """
    try:
        prepared = prepareQuery(query, initNs={**dict(prefixes), **PREFIXES})
        patterns = set(_patterns(prepared.algebra))
        if prepared.algebra.name == "DescribeQuery":
            for described in prepared.algebra["PV"]:
                patterns |= {(_known(described), None, None), (None, None, _known(described))}
    except Exception:  # rdflib supports less than Oxigraph, and fails in many ways
        return None
    return frozenset(patterns)


def _patterns(node: Any) -> Iterator[Pattern]:
    """Yield every triple pattern below a node of the algebra."""
    if isinstance(node, CompValue):
        for key, child in node.items():
            if key == "triples":
                for s, p, o in child:
                    yield from _of_pattern(s, p, o)
            else:
                yield from _patterns(child)
    elif isinstance(node, list | tuple | set | frozenset):
        for child in node:
            yield from _patterns(child)


def _known(node: Any) -> Term | None:
    return None if isinstance(node, Variable | BNode) else str(node.n3())


def _of_pattern(s: Any, p: Any, o: Any) -> Iterator[Pattern]:
    match p:
        case URIRef() | Variable():
            yield (_known(s), _known(p), _known(o))
        case InvPath():
            yield from _of_pattern(o, p.arg, s)
        case SequencePath():
            ends = [s, *(BNode() for _ in p.args[1:]), o]
            for step, start, end in zip(p.args, ends, ends[1:], strict=False):
                yield from _of_pattern(start, step, end)
        case AlternativePath():
            for step in p.args:
                yield from _of_pattern(s, step, o)
        case MulPath() if not p.zero:
            yield from _of_pattern(BNode(), p.path, BNode())
        case Path() | _:
            raise _Anything
