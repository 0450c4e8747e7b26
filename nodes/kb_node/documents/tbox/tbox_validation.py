"""Validation of a TBox, and of a map against it."""

from __future__ import annotations

from collections.abc import Iterable

from semmap.nodes.kb_node import proofs
from semmap.nodes.kb_node.documents import abox_document, ontology_files
from semmap.nodes.kb_node.entities.class_table import ClassTable
from semmap.nodes.kb_node.reasoner import Inconsistent, Reasoner
from semmap.nodes.kb_node.reasoner.rules.facts import Facts
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.explanations import Triple


class DoesNotFit(errors.Refused):
    """The map contains something that the TBox does not support."""


def compile_tbox(tbox: Iterable[Triple], name: str = "", *, closed: Facts | None = None) -> Reasoner:
    """Return a reasoner with only the TBox, whose closure is `closed`, if that is known.

    Raises Inconsistent; BadFile if it is not a TBox.
    """
    what = f"the TBox {name}".strip()
    try:
        reasoner = Reasoner(tbox, closed=closed)
    except Inconsistent as error:
        raise proofs.to_error(error, of=what) from None
    if not ClassTable(reasoner).names:
        raise errors.BadFile(f"{name or what} has no class: is it a TBox (an OWL ontology with classes)?")
    return reasoner


def require_fit(abox: Iterable[Triple], before: ClassTable, after: ClassTable) -> None:
    """Raise DoesNotFit if the TBox lacks classes of the ABox, or entities would lose their spatial class."""
    abox = list(abox)
    try:
        abox_document.filter_document(abox, after, skip_unknown=False)
    except errors.UnknownClass as error:
        raise DoesNotFit(f"the map does not fit the TBox: {error.text.partition('; --')[0]}") from None
    types = [(s, o) for s, p, o in abox if p == v.RDF_TYPE]
    spatial = {s for s, o in types if o in after.spatial}
    lost = [(s, o) for s, o in types if o in before.spatial and s not in spatial]
    for individual, c in lost:
        raise DoesNotFit(
            f"the map does not fit the TBox: {v.local_name(individual)} would lose its spatial class,"
            f" because the TBox does not say that {v.local_name(c)} is spatial"
        )


def has_individuals(tbox: Iterable[Triple]) -> bool:
    """Return whether it describes individuals, so that it may have entities."""
    tbox = list(tbox)
    kinds = (v.OWL_OBJECT_PROPERTY, v.OWL_DATATYPE_PROPERTY)
    properties = {s for s, p, o in tbox if p == v.RDF_TYPE and o in kinds}
    return any(p in properties or (p == v.RDF_TYPE and not abox_document.is_built_in(o)) for _, p, o in tbox)


def described_by(tbox: Iterable[Triple], classes: ClassTable) -> list[str]:
    """Return the names of the entities that a TBox describes, which no command can change."""
    return sorted({v.entity_name(s) for s, p, o in tbox if p == v.RDF_TYPE and o in classes.spatial})


def import_triples(tbox: Iterable[Triple]) -> list[Triple]:
    """Return `owl:imports` triples for the ABox. They refer to the loaded file, never to the network."""
    ontologies = [term for term in ontology_files.header(tbox).ontologies if term.startswith("<")]
    return [(v.ABOX_ONTOLOGY, v.OWL_IMPORTS, iri) for iri in ontologies]
