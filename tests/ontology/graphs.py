"""Reading the ontology with rdflib and closing it with owlrl: what the tests compare with."""

from decimal import Decimal
from pathlib import Path

import owlrl
import rdflib
from owlrl.DatatypeHandling import AltXSDToPYTHON
from rdflib import OWL, RDF, RDFS, XSD, Graph, URIRef

from ontology.vocabulary import ABOX, TBOX

DM = rdflib.Namespace(TBOX)
MAP = rdflib.Namespace(ABOX)

_ERROR = URIRef("http://www.daml.org/2002/03/agents/agent-ont#error")
_ANNOTATIONS = (RDFS.label, RDFS.comment, DM.model, DM.fixed, OWL.versionInfo)


def read(*paths: Path) -> Graph:
    graph = Graph(store="SimpleMemory")
    for path in paths:
        graph.parse(path, format="turtle")
    return graph


def classes(graph: Graph) -> set[URIRef]:
    return {c for c in graph.subjects(RDF.type, OWL.Class) if isinstance(c, URIRef)}


def named(name: str) -> URIRef:
    return URIRef(TBOX + name)


def local(term: rdflib.term.Node) -> str:
    return str(term).rpartition("#")[2]


def superclasses(graph: Graph, cls: URIRef) -> set[URIRef]:
    """The class and its named superclasses, as asserted."""
    found = graph.transitive_objects(cls, RDFS.subClassOf)
    return {c for c in found if isinstance(c, URIRef)}


def close(graph: Graph) -> list[str]:
    """Add all that follows from the graph under OWL 2 RL, and return what makes it inconsistent.

    Annotations are dropped: nothing follows from them, and they double owlrl's time.
    """
    for annotation in _ANNOTATIONS:
        graph.remove((None, annotation, None))
    owlrl_float = AltXSDToPYTHON[XSD.float]
    AltXSDToPYTHON[XSD.float] = Decimal  # owlrl's own refuses 0.0
    try:
        owlrl.DeductiveClosure(owlrl.OWLRL_Semantics).expand(graph)
    finally:
        AltXSDToPYTHON[XSD.float] = owlrl_float
    return sorted(str(error) for error in graph.objects(None, _ERROR))
