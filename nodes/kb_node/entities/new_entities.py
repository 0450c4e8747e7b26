"""Predicts where very many new entities will be, before a transaction is planned, checked and read.

The result may be wrong, because other triples and inference may change it. The caller must compare it with
the actual entities.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Final

from semmap.nodes.kb_node.entities.class_table import ClassTable
from semmap.nodes.kb_node.relations.facts.precompute_messages import (
    ClassModel,
    ExpectedEntities,
    ExpectedEntity,
)
from semmap.ontology import vocabulary as v
from semmap.ontology.entity_triples import group_by_property
from semmap.schemas.commits import NewEntity, Transaction
from semmap.schemas.explanations import Term, Triple

MANY: Final = 10_000
"""Entities below which the prediction is not worth it."""
MOST: Final = 250_000
"""Entities above which the process, which needs 5 kB for each, takes too much memory."""
_LEAST: Final = 5
"""Least number of triples that place an entity."""
_SHAPING: Final = (
    v.MODEL, v.HAS_EXTENT, v.IS_OPEN, v.OPENNESS, v.JOINT_POSITIONS, v.IS_GRASPED_BY,
    v.ENTITY_NAME,
)  # fmt: skip
"""Properties of entities with a shape or a name of their own, or that are attached."""
_Said = Mapping[Term, Sequence[Triple]]
"""Triples by property."""


def predict_new_entities(transaction: Transaction, classes: ClassTable) -> ExpectedEntities | None:
    """Return the entities that a transaction adds, or None if they are too few, too many or not regular."""
    if transaction.remove or transaction.edit or transaction.retract or classes.alignments:
        return None
    if MANY <= len(transaction.add) <= MOST and not transaction.insert:
        return _wanted(transaction.add, classes)
    if len(transaction.insert) >= MANY * _LEAST and not transaction.add:
        return _said(transaction.insert, classes)
    return None


def _wanted(add: Sequence[NewEntity], classes: ClassTable) -> ExpectedEntities | None:
    class_of = {new.class_iri: v.iri(new.class_iri) for new in add}
    if any(new.set for new in add) or not classes.spatial.issuperset(class_of.values()):
        return None
    appearances, rows = _looks(class_of.values(), classes)
    row = {iri: rows[c] for iri, c in class_of.items()}
    arrivals = [
        ExpectedEntity(v.entity_iri(n.name), row[n.class_iri], pose.position_m, pose.orientation_wxyz, n.size)
        for n in add
        if (pose := n.pose) is not None
    ]
    return ExpectedEntities(appearances, arrivals)


def _said(insert: Iterable[Triple], classes: ClassTable) -> ExpectedEntities | None:
    by_property = group_by_property(insert)
    at = {s: o for s, _, o in by_property.get(v.HAS_POSITION, ())}
    if not MANY <= len(at) <= MOST or not by_property.keys().isdisjoint(_SHAPING):
        return None
    things, nodes = list(at), list(at.values())
    sizes = [node or "" for node in _objects(by_property, v.HAS_SIZE, things)]
    spatial = classes.spatial
    class_of = {s: o for s, _, o in by_property.get(v.RDF_TYPE, ()) if o in spatial}
    position, turn, size = (
        [_objects(by_property, p, of) for p in properties]
        for properties, of in ((v.COORDINATE_XYZ, nodes), (v.ORIENTATION_WXYZ, nodes), (v.SIZE_XYZ, sizes))
    )
    if not at.keys() <= class_of.keys() or any(None in column for column in position):
        return None
    appearances, rows = _looks(class_of.values(), classes)
    appearance = map(rows.__getitem__, map(class_of.__getitem__, things))
    numbers = (zip(*columns, strict=True) for columns in (position, turn, size))
    return ExpectedEntities(appearances, list(map(ExpectedEntity, things, appearance, *numbers)))


def _objects(by_property: _Said, property_: Term, subjects: Sequence[Term]) -> list[Term | None]:
    """Return the last object of each subject for a property, or None for those without."""
    triples = by_property.get(property_, ())
    if [s for s, _, _ in triples] == subjects:  # the usual order
        return [o for _, _, o in triples]
    found = {s: o for s, _, o in triples}
    return [found.get(s) for s in subjects]


def _looks(classes_of: Iterable[Term], classes: ClassTable) -> tuple[list[ClassModel], dict[Term, int]]:
    """Return the appearance of the classes, and the index of the appearance by class."""
    rows = {c: row for row, c in enumerate(dict.fromkeys(classes_of))}
    return [ClassModel(classes.models[c], c in classes.places, c in classes.fixed) for c in rows], rows
