"""Which commits may touch the rows of a query: a sound over-estimate, read off its triple patterns."""

from __future__ import annotations

import logging
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

from rdflib import RDF, BNode, URIRef, Variable
from rdflib.paths import AlternativePath, InvPath, MulPath, Path, SequencePath
from rdflib.plugins.sparql import prepareQuery
from rdflib.plugins.sparql.parserutils import CompValue

from nodes.kb_node.sparql.queries.text import PREFIXES
from ontology import vocabulary as v
from schemas.explanations import Term, Triple

logging.getLogger("rdflib").setLevel(logging.ERROR)


class _Anything(Exception):
    """Any triple may matter."""


@dataclass(frozen=True)
class Footprint:
    """The predicates and classes that a query looks at; None stands for all of them."""

    predicates: frozenset[Term] | None = None
    classes: frozenset[Term] | None = None

    def is_touched(self, changed: Iterable[Triple]) -> bool:
        """May rows change when these triples come or go?"""
        return any(self._looks_at(p, o) for _, p, o in changed)

    def _looks_at(self, p: Term, o: Term) -> bool:
        if self.predicates is None or p in self.predicates:
            return True
        return p == v.RDF_TYPE and (self.classes is None or o in self.classes)


def footprint(query: str) -> Footprint:
    """What a query looks at; everything, for one whose patterns cannot be told.

    `owl:` and other prefixes are those of `text.PREFIXES`. A type pattern with a class counts for that class
    only. A path that may have no steps relates every term to itself, so any triple matters to it.
    """
    try:
        algebra = prepareQuery(query, initNs=PREFIXES).algebra
        patterns = set(_patterns(algebra))
    except Exception:  # rdflib reads less than Oxigraph, and fails in many ways on what it does not read
        return Footprint()
    predicates = frozenset(p for p, _ in patterns if p != v.RDF_TYPE)
    classes = [o for p, o in patterns if p == v.RDF_TYPE]
    return Footprint(predicates, None if None in classes else frozenset(filter(None, classes)))


def _patterns(node: Any) -> Iterator[tuple[Term, Term | None]]:
    """Predicate and object (None for any) of every triple pattern below a node of the algebra."""
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


def _of_pattern(s: Any, p: Any, o: Any) -> Iterator[tuple[Term, Term | None]]:
    match p:
        case URIRef():
            known = p == RDF.type and not isinstance(o, Variable | BNode)
            yield (p.n3(), o.n3() if known else None)
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
