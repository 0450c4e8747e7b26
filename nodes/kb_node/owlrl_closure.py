"""The closure by owlrl, run as a process of its own: N-Triples on stdin, one fault a line on stdout."""

from __future__ import annotations

import sys
from collections.abc import Iterator

import owlrl
from owlrl.DatatypeHandling import AltXSDToPYTHON
from rdflib import OWL, RDF, RDFS, XSD, Graph, Literal, URIRef

_ERROR = URIRef("http://www.daml.org/2002/03/agents/agent-ont#error")


def close(graph: Graph) -> list[str]:
    """Add all that follows under OWL 2 RL to `graph`; what makes it inconsistent, in owlrl's words.

    Annotations are dropped first: nothing follows from them, and they double owlrl's time. Two faults of
    owlrl are mended: it takes 0.0 for no float, and it does not notice when a functional property makes two
    different literals the same (rule dt-diff).
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
    graph = Graph(store="SimpleMemory")
    graph.parse(data=sys.stdin.read(), format="nt")
    print("\n".join(close(graph)))
