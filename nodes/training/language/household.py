"""The vocabulary of the household TBox."""

from __future__ import annotations

import functools
from dataclasses import replace
from importlib import resources

import rdflib
from rdflib.namespace import OWL, RDF, RDFS

from semmap.nodes.language import lexicon
from semmap.nodes.language.vocabulary import Vocabulary, vocabulary


@functools.cache
def household(language: str = "english", *, synonyms: bool = True) -> Vocabulary:
    """Return the classes of `household.ttl` by their labels in all languages and our synonyms."""
    graph = rdflib.Graph().parse(str(resources.files("ontology") / "household.ttl"))
    classes = sorted(c for c in graph.subjects(RDF.type, OWL.Class) if isinstance(c, rdflib.URIRef))
    labels = [
        (_local(c), str(label)) for c in classes for label in sorted(graph.objects(c, RDFS.label), key=str)
    ]
    named = [(_local(c), _local(c)) for c in classes]
    above = [
        (_local(c), _local(superclass))
        for c in classes
        for superclass in graph.objects(c, RDFS.subClassOf)
        if isinstance(superclass, rdflib.URIRef)
    ]
    words = lexicon.load(language)
    return vocabulary([*labels, *named], above, words if synonyms else replace(words, synonyms={}))


def _local(term: object) -> str:
    return str(term).rsplit("#", 1)[-1]
