"""The TBox classes of the library's models, and their superclasses."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from rdflib import OWL, RDF, RDFS, Graph, URIRef

from semmap.ontology import vocabulary as v

HOUSEHOLD = Path(v.__file__).with_name("household.ttl")
_TOP = {"Physical_Thing", "Thing"}


def hierarchy(tbox: Path = HOUSEHOLD) -> dict[str, tuple[str, ...]]:
    """Return the superclasses of each class below `Physical_Thing`, the most specific first."""
    parents = _parents(Graph().parse(tbox))
    above = {name: _closure(name, parents) for name in parents}
    return {
        name: tuple(sorted(found - _TOP, key=lambda other: (-len(above[other]), other)))
        for name, found in above.items()
    }


def class_of_models(models: Mapping[str, object], tbox: Path = HOUSEHOLD) -> dict[str, str]:
    """Return the class of a model: the one with its name, or the most general one that has this model."""
    graph = Graph().parse(tbox)
    classes = {
        str(s).partition("#")[2]: s for s in graph.subjects(RDF.type, OWL.Class) if isinstance(s, URIRef)
    }
    by_name = {name.lower(): name for name in classes}
    above = hierarchy(tbox)
    looks: dict[str, list[str]] = {}
    for s, o in graph.subject_objects(URIRef(v.bare(v.MODEL))):
        looks.setdefault(str(o), []).append(str(s).partition("#")[2])
    found = {}
    for model in models:
        if model in by_name:
            found[model] = by_name[model]
        elif model in looks:
            found[model] = min(looks[model], key=lambda name: (len(above[name]), name))
    return found


def _parents(graph: Graph) -> dict[str, set[str]]:
    parents: dict[str, set[str]] = {}
    for s in graph.subjects(RDF.type, OWL.Class):
        if isinstance(s, URIRef):
            above = (o for o in graph.objects(s, RDFS.subClassOf) if isinstance(o, URIRef))
            parents[str(s).partition("#")[2]] = {str(o).partition("#")[2] for o in above}
    return parents


def _closure(name: str, parents: Mapping[str, set[str]]) -> set[str]:
    found: set[str] = set()
    ahead = set(parents.get(name, ()))
    while ahead:
        above = ahead.pop()
        if above not in found:
            found.add(above)
            ahead |= parents.get(above, set())
    return found
