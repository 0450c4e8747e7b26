"""Reading the ontology with rdflib and closing it with owlrl: what the tests compare with."""

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


def forget_unused_classes(graph: Graph) -> None:
    """Drop what is said of named classes that no individual can be inferred to belong to.

    It changes nothing that follows for the individuals, and owlrl's time by half.
    """
    used = set(graph.objects(None, RDF.type)) | set(graph.subjects(OWL.equivalentClass, None))
    used |= set(graph.objects(None, RDFS.domain)) | set(graph.objects(None, RDFS.range))
    kept = {c for cls in used for c in graph.transitive_objects(cls, RDFS.subClassOf)}
    doomed: list[rdflib.term.Node] = [c for c in classes(graph) if c not in kept]
    while doomed:
        subject = doomed.pop()
        doomed += [o for o in graph.objects(subject) if isinstance(o, rdflib.BNode)]
        graph.remove((subject, None, None))


def close(graph: Graph) -> list[str]:
    """Add all that follows from the graph under OWL 2 RL, and return what makes it inconsistent.

    Annotations are dropped: nothing follows from them, and they double owlrl's time.
    """
    for annotation in _ANNOTATIONS:
        graph.remove((None, annotation, None))
    owlrl_float = AltXSDToPYTHON[XSD.float]
    AltXSDToPYTHON[XSD.float] = float  # owlrl's own refuses 0.0
    try:
        owlrl.DeductiveClosure(owlrl.OWLRL_Semantics).expand(graph)
    finally:
        AltXSDToPYTHON[XSD.float] = owlrl_float
    errors = [str(error) for error in graph.objects(None, _ERROR)]
    return sorted([*errors, *_unequal_literals(graph)])


def _unequal_literals(graph: Graph) -> list[str]:
    """Rule dt-diff, which owlrl lacks: literals that came out the same and are not."""
    return [
        f"{a.n3()} is not {b.n3()}"
        for a, b in graph.subject_objects(OWL.sameAs)
        if isinstance(a, rdflib.Literal) and isinstance(b, rdflib.Literal)
        if (a.value, a.language) != (b.value, b.language)
    ]
