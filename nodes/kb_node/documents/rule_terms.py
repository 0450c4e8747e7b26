"""Classes and properties of SWRL rules that are not declared, and are probably misspelt."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Set
from typing import Final

from semmap.nodes.kb_node.reasoner import datatypes
from semmap.nodes.kb_node.reasoner.rules import swrl
from semmap.ontology import vocabulary as v
from semmap.schemas import wording
from semmap.schemas.explanations import Term, Triple

_DECLARATIONS: Final = frozenset((v.OWL_CLASS, v.RDFS_CLASS, v.iri(f"{v.RDFS}Datatype"), *v.PROPERTY_KINDS))
_BUILT_IN: Final = tuple(f"<{namespace}" for namespace in (v.RDF, v.RDFS, v.OWL, v.XSD))
_FEW: Final = 5


def undeclared_terms(triples: Iterable[Triple], known: Set[Term] = frozenset()) -> list[Term]:
    """Return the named classes and properties of supported SWRL rules that neither declares, sorted.

    `known` terms are declared elsewhere.
    """
    triples = list(triples)
    used = {
        atom.predicate
        for rule in swrl.read_triples(triples).supported
        for atom in (*rule.body, *((rule.head,) if rule.head else ()))
        if atom.kind in (swrl.CLASS, swrl.PROPERTY)
    }
    named = {
        term
        for term in used - known
        if term.startswith("<") and not term.startswith(_BUILT_IN) and not datatypes.is_datatype(term)
    }
    return (
        sorted(named - {s for s, p, o in triples if p == v.RDF_TYPE and o in _DECLARATIONS}) if named else []
    )


def undeclared_note(terms: Collection[Term]) -> str:
    """Return a note on undeclared terms of rules, or ""."""
    if not terms:
        return ""
    few = wording.few([v.local_name(term) for term in terms], _FEW)
    return f"{wording.counted(len(terms), 'term')} of SWRL rules not declared: {few}; check the spelling"
