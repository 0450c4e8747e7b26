"""The closure by owlrl as a separate process: N-Triples on stdin, one inconsistency per line on stdout."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator
from typing import Any, Self

import owlrl
from owlrl.DatatypeHandling import AltXSDToPYTHON
from rdflib import OWL, RDF, RDFS, XSD, Graph, Literal, URIRef

_ERROR = URIRef("http://www.daml.org/2002/03/agents/agent-ont#error")


class QuickGraph(Graph):
    """An in-memory graph with fast look-ups of single triples, which owlrl does very often."""

    def __init__(self) -> None:
        super().__init__(store="SimpleMemory")
        self._triples: set[Any] = set()

    def add(self, triple: Any) -> Self:
        """Add a triple."""
        self._triples.add(triple)
        return super().add(triple)

    def addN(self, quads: Iterable[Any]) -> Self:  # noqa: N802
        """Add the triples of quads."""
        for s, p, o, _ in quads:
            self.add((s, p, o))
        return self

    def remove(self, triple: Any) -> Self:
        """Remove the triples that match a pattern."""
        self._triples.difference_update(list(self.triples(triple)))
        return super().remove(triple)

    def __contains__(self, triple: Any) -> bool:
        return triple in self._triples or super().__contains__(triple)


def close(graph: Graph) -> list[str]:
    """Add the OWL 2 RL closure to `graph`; return the inconsistencies in owlrl's words.

    Annotations are removed first: they have no consequences, and double the run time. Two bugs of owlrl are
    worked around: it rejects 0.0 as a float, and it misses different literals that a functional property
    equates (rule dt-diff).
    """
    for annotation in (*graph.subjects(RDF.type, OWL.AnnotationProperty), RDFS.label, RDFS.comment):
        graph.remove((None, annotation, None))
    owlrl_float = AltXSDToPYTHON[XSD.float]
    AltXSDToPYTHON[XSD.float] = float
    try:
        owlrl.DeductiveClosure(owlrl.OWLRL_Semantics).expand(graph)
    finally:
        AltXSDToPYTHON[XSD.float] = owlrl_float
    described = {str(o).replace("\n", " ") for o in graph.objects(None, _ERROR)}
    return sorted(described | set(_unequal_literals(graph)))


def _unequal_literals(graph: Graph) -> Iterator[str]:
    for a, b in graph.subject_objects(OWL.sameAs):
        if isinstance(a, Literal) and isinstance(b, Literal) and a.value != b.value:
            yield f"{a.n3()} is not {b.n3()}"


if __name__ == "__main__":
    graph = QuickGraph()
    graph.parse(data=sys.stdin.read(), format="nt")
    print("\n".join(close(graph)))
