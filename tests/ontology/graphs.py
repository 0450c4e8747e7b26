"""Reading the ontology with rdflib: what the tests compare with."""

from pathlib import Path

import rdflib
from rdflib import OWL, RDF, RDFS, Graph, URIRef

from semmap.nodes.kb_node.owlrl.closure_process import QuickGraph
from semmap.ontology.vocabulary import ABOX, TBOX

DM = rdflib.Namespace(TBOX)
MAP = rdflib.Namespace(ABOX)


def read(*paths: Path) -> Graph:
    graph = QuickGraph()
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
    """Drop the axioms of named classes without possible instances.

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
