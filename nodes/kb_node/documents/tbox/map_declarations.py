"""Classes, properties and axioms that the file of a map declares beside its individuals."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Final, NamedTuple

from semmap.nodes.kb_node.documents import blank_nodes
from semmap.nodes.kb_node.reasoner.data_ranges import FACETS
from semmap.nodes.kb_node.reasoner.tbox.split import is_schema
from semmap.ontology import vocabulary as v
from semmap.schemas import wording
from semmap.schemas.explanations import Term, Triple

_OF_INDIVIDUALS: Final = frozenset(
    v.iri(f"{v.OWL}{name}") for name in ("AllDifferent", "NegativePropertyAssertion")
)
"""Axioms about individuals."""
_OF_PARTS: Final = frozenset((v.RDF_FIRST, v.RDF_REST, *FACETS))
"""Properties of the nameless parts of axioms, which lists of individuals have, too."""
_CLASSES: Final = frozenset((v.OWL_CLASS, v.RDFS_CLASS))


class Declarations(NamedTuple):
    """The triples of a document that declare something, and the others."""

    declared: list[Triple]
    others: list[Triple]


def split_declarations(triples: Sequence[Triple], tbox: Iterable[Triple] = ()) -> Declarations:
    """Split a document into the statements about classes and properties, with rules and axioms, and the rest.

    Nameless class expressions that only individuals use belong to the rest. Blank nodes that `tbox` describes
    in the same way get its labels.
    """
    subjects = _find_declared(triples)
    declared = [triple for triple in triples if triple[0] in subjects]
    others = [triple for triple in triples if triple[0] not in subjects]
    labels = blank_nodes.find_matches(declared, list(tbox))
    return Declarations(
        list(blank_nodes.relabel(declared, labels)), list(blank_nodes.relabel(others, labels))
    )


def _find_declared(triples: Sequence[Triple]) -> set[Term]:
    """Return the subjects that are declared, with the blank nodes that describe them."""
    nameless = {o for _, _, o in triples if o.startswith("_:")}
    facts = {s for s, p, o in triples if p == v.RDF_TYPE and o in _OF_INDIVIDUALS}
    found = {
        s
        for s, p, o in triples
        if p not in _OF_PARTS and s not in nameless and s not in facts and is_schema((s, p, o))
    }
    parts: dict[Term, list[Term]] = {}
    for s, _, o in triples:
        if o.startswith("_:"):
            parts.setdefault(s, []).append(o)
    pending = list(found)
    while pending:
        new = [o for o in parts.get(pending.pop(), ()) if o not in found]
        found.update(new)
        pending += new
    return found


def describe(declared: Iterable[Triple]) -> str:
    """Return a note on the classes and properties that a map's file adds to the TBox."""
    types = [(s, o) for s, p, o in declared if p == v.RDF_TYPE and s.startswith("<")]
    classes = {s for s, o in types if o in _CLASSES}
    properties = {s for s, o in types if o in v.PROPERTY_KINDS}
    counts = (
        wording.counted(len(classes), "class", "classes"),
        wording.counted(len(properties), "property", "properties"),
    )
    return f"added to the TBox: {' and '.join(counts)} of the file"
