"""What a TBox must be to hold, and whether a map fits it."""

from __future__ import annotations

from collections.abc import Iterable

from semmap.nodes.kb_node import proofs
from semmap.nodes.kb_node.documents import abox_document, ontology_files
from semmap.nodes.kb_node.entities.class_table import ClassTable
from semmap.nodes.kb_node.reasoner import Inconsistent, Reasoner
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.explanations import Triple


class DoesNotFit(errors.Refused):
    """The map says what a TBox has no room for."""


def compile_tbox(tbox: Iterable[Triple], name: str = "") -> Reasoner:
    """A reasoner with no more than the TBox. Raises Inconsistent, BadFile for what is no TBox."""
    what = f"the TBox {name}".strip()
    try:
        reasoner = Reasoner(tbox)
    except Inconsistent as error:
        raise proofs.to_error(error, of=what) from None
    if not ClassTable(reasoner).names:
        raise errors.BadFile(f"{name or what} has no class: is it a TBox (an OWL ontology with classes)?")
    return reasoner


def require_fit(abox: Iterable[Triple], before: ClassTable, after: ClassTable) -> None:
    """Raises DoesNotFit when the ABox has classes that the TBox has not, or things in space would be none."""
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
    """Does it say anything of individuals, so that it may have entities?"""
    tbox = list(tbox)
    kinds = (v.OWL_OBJECT_PROPERTY, v.OWL_DATATYPE_PROPERTY)
    properties = {s for s, p, o in tbox if p == v.RDF_TYPE and o in kinds}
    return any(p in properties or (p == v.RDF_TYPE and not abox_document.is_built_in(o)) for _, p, o in tbox)


def described_by(tbox: Iterable[Triple], classes: ClassTable) -> list[str]:
    """The names of the entities that a TBox itself describes: no command can change what a TBox says."""
    return sorted({v.entity_name(s) for s, p, o in tbox if p == v.RDF_TYPE and o in classes.spatial})


def import_triples(tbox: Iterable[Triple]) -> list[Triple]:
    """`owl:imports` of the TBox, for the ABox: it is resolved to the loaded file, never to the network."""
    ontologies = [term for term in ontology_files.header(tbox).ontologies if term.startswith("<")]
    return [(v.ABOX_ONTOLOGY, v.OWL_IMPORTS, iri) for iri in ontologies]
