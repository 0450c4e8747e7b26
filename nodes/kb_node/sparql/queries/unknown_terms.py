"""Notes on terms of a query that the map does not contain, which may explain an empty result."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from itertools import islice

import pyoxigraph as ox
import rapidfuzz.fuzz
import rapidfuzz.process
import rapidfuzz.utils  # noqa: F401  a reader is without files, so what `did_you_mean` needs is there before

from semmap.nodes.kb_node.sparql.queries.predicates import terms_of
from semmap.nodes.kb_node.sparql.triples.dataset import Dataset
from semmap.ontology import prefixes
from semmap.ontology import vocabulary as v
from semmap.schemas import errors

_OTHERS = frozenset({v.RDF, v.RDFS, v.OWL, v.XSD, prefixes.WELL_KNOWN["vann"]})
"""Namespaces of which the map does not contain all terms."""
_ESCAPE = re.compile(r"\\(.)")
_KINDS = (*v.PROPERTY_KINDS, v.OWL_CLASS, v.RDFS_CLASS)
_COMPARED = 2000
"""Individuals whose names are compared; the number is limited because a query may be frequent."""


def unknown_term_notes(query: str, dataset: Dataset, known: Mapping[str, str]) -> Iterator[str]:
    """Yield a note for each IRI of a query that is in no triple, with similar names.

    `known` are the prefixes that the query need not declare.
    """
    declared = dict(known)
    there: dict[str, str] = {}
    before = ("", "")
    for text in terms_of(query):
        if before[0].upper() == "PREFIX" and text.startswith("<"):
            declared[before[1].removesuffix(":")] = text[1:-1]
        elif before[1].upper() != "PREFIX":  # otherwise it is a declaration
            if text.startswith("<"):
                there[text[1:-1]] = text
            else:
                prefix, colon, local = text.partition(":")
                if colon and prefix in declared and local:
                    there[declared[prefix] + _ESCAPE.sub(r"\1", local)] = text
        before = (before[1], text)
    for iri, text in there.items():
        namespace, local = prefixes.split(f"<{iri}>")
        if namespace in _OTHERS or ":" not in iri or _is_mentioned(dataset, ox.NamedNode(iri)):
            continue
        begin = "" if text.startswith("<") else text.partition(":")[0] + ":"
        near = [f"{begin}{name}" for name in errors.nearest(local, _called(dataset, namespace))]
        meant = f"; did you mean {errors.enumerated(near)}?" if near else ""
        yield f"unknown term {text}{meant}"


def _is_mentioned(dataset: Dataset, node: ox.NamedNode) -> bool:
    patterns = ((node, None, None), (None, node, None), (None, None, node))
    return any(next(dataset.store.quads_for_pattern(*pattern), None) is not None for pattern in patterns)


def _called(dataset: Dataset, namespace: str) -> set[str]:
    """Return the local names of a namespace; if there are many individuals, only some of them."""
    type_ = ox.NamedNode(v.bare(v.RDF_TYPE))
    typed = (
        dataset.store.quads_for_pattern(None, type_, None if kind is None else ox.NamedNode(v.bare(kind)))
        for kind in (*_KINDS, None)
    )
    iris = {
        quad.subject.value
        for quads in typed
        for quad in islice(quads, _COMPARED)
        if isinstance(quad.subject, ox.NamedNode)
    }
    return {iri.removeprefix(namespace) for iri in iris if iri.startswith(namespace)}
