"""A second opinion on consistency, by owlrl: slow, independent of our own reasoner, in its own process."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterable, Iterator

import owlrl
from owlrl.DatatypeHandling import AltXSDToPYTHON
from rdflib import OWL, RDF, RDFS, XSD, Graph, Literal, URIRef

from schemas import errors
from schemas.explanations import Triple

TIMEOUT_S = 600.0
_ERROR = URIRef("http://www.daml.org/2002/03/agents/agent-ont#error")


def owlrl_faults(triples: Iterable[Triple]) -> list[str]:
    """What owlrl finds wrong; empty when it finds the triples consistent. Takes minutes for a large map.

    Raises Refused when it does not come to an end.
    """
    document = "".join(f"{s} {p} {o} .\n" for s, p, o in triples)
    try:
        run = subprocess.run(
            [sys.executable, "-m", __name__],
            input=document,
            capture_output=True,
            text=True,
            timeout=TIMEOUT_S,
        )
    except subprocess.TimeoutExpired:
        raise errors.Refused(
            f"owlrl came to no end within {TIMEOUT_S:g} s; the map is too large for it"
        ) from None
    if run.returncode != 0:
        raise errors.Refused(f"owlrl failed: {(run.stderr.strip() or str(run.returncode)).splitlines()[-1]}")
    return [line for line in run.stdout.splitlines() if line]


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
