"""Entities and TBox terms in the form that the search by description needs."""

from __future__ import annotations

from collections.abc import Iterator

from semmap.nodes.kb_node.entities.class_table import ClassTable
from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.nodes.language.reference_resolution.map_index import Item, Terms
from semmap.ontology import vocabulary as v
from semmap.schemas.entities import Entity

_HAS_AFFORDANCE = v.dm("hasAffordance")


def item(entity: Entity) -> Item:
    """Return an entity as a search item."""
    references = filter(None, (entity.preferred_reference, *entity.alternative_references))
    values: dict[str, frozenset[object]] = {
        name: frozenset(value if isinstance(value, tuple) else (value,))
        for name, value in entity.properties.items()
    }
    return Item(entity.name, entity.class_, frozenset(entity.types), tuple(references), values, entity.place)


def terms(reasoner: Reasoner, classes: ClassTable) -> Terms:
    """Return the classes, values and affordances of a TBox with their labels."""
    rows = [row for row in classes.rows if row.spatial]
    named = [(language, row.name, text) for row in rows for language, text in row.labels.items()]
    named += [("", row.name, text) for row in rows for text in row.also]
    named += [("en" if row.labels else "", row.name, row.name) for row in rows]
    values = {value for row in classes.property_table.rows() if row.kind == "object" for value in row.values}
    affordances = {v.local_name(i) for i in reasoner.instances(v.dm("Affordance"))}
    return Terms(
        tuple(named),
        tuple(_labels(reasoner, values - affordances)),
        tuple(_labels(reasoner, affordances)),
        _affords(reasoner, classes),
    )


def _labels(reasoner: Reasoner, names: set[str]) -> Iterator[tuple[str, str, str]]:
    for name in sorted(names):
        for _, _, label in reasoner.asserted(v.dm(name), v.RDFS_LABEL, None):
            yield v.language_of(label) or "", name, v.lexical(label)


def _affords(reasoner: Reasoner, classes: ClassTable) -> dict[str, frozenset[str]]:
    """Return by class which affordances the TBox states for its instances."""
    found: dict[str, set[str]] = {}
    for restriction, _, value in reasoner.asserted(None, v.iri(f"{v.OWL}hasValue"), None):
        if any(reasoner.asserted(restriction, v.iri(f"{v.OWL}onProperty"), _HAS_AFFORDANCE)):
            for cls, _, _ in reasoner.asserted(None, v.RDFS_SUB_CLASS_OF, restriction):
                if (name := classes.names.get(cls)) is not None:
                    found.setdefault(name, set()).add(v.local_name(value))
    return {name: frozenset(values) for name, values in found.items()}
