"""Reads individuals that are not in space: persons, organisations, events, units.

They are read as entities without a pose, a size and a body, so that the same commands print and change them.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Final

from semmap.nodes.kb_node.entities import aligned_values, entity_reading, equal_individuals
from semmap.nodes.kb_node.entities.class_table import ClassTable
from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.ontology import vocabulary as v
from semmap.schemas.entities import SAME_AS, Entity, Provenance
from semmap.schemas.explanations import Term

_DESCRIBING: Final = frozenset(
    (v.COORDINATES, v.THREE_DIM_SIZE, v.PREFERRED_REFERENCE, v.ALTERNATIVE_REFERENCE)
)
"""The classes of individuals that hold the pose, the size and the labels of an entity."""
_SCHEMA: Final = tuple(
    f"<{namespace}"
    for namespace in (v.OWL, v.RDF, v.RDFS, "http://www.w3.org/2003/11/swrl#", "http://www.w3.org/ns/shacl#")
)
"""The vocabularies of declarations, axioms, rules and shapes."""
_NO_KIND: Final = frozenset((v.OWL_THING, v.OWL_NAMED_INDIVIDUAL))
_OF_SCHEMAS: Final = frozenset(
    (
        *(v.RDFS_SUB_CLASS_OF, v.RDFS_SUB_PROPERTY_OF, v.RDFS_DOMAIN, v.RDFS_RANGE),
        v.iri(f"{v.OWL}equivalentClass"),
    )
)
"""Properties of classes and properties."""
_UNKNOWN: Final = Provenance(
    commit=0, stamp_ns=0, source="file", reason="not in space: only get returns its commits"
)
_MAX_PATH: Final = 8


def may_be_individual(classes: ClassTable, term: Term, types: list[Term]) -> bool:
    """Return whether a term with these asserted classes can be an individual that is not in space."""
    return (
        term.startswith("<")
        and not term.startswith(_SCHEMA)
        and _DESCRIBING.isdisjoint(types)
        and classes.spatial.isdisjoint(types)
        and not any(o.startswith(_SCHEMA) and o not in _NO_KIND for o in types)
    )


def is_individual(reasoner: Reasoner, classes: ClassTable, term: Term) -> bool:
    """Return whether something is asserted about a term, and it is an individual that is not in space.

    This excludes individuals that only describe an entity: those that hold its pose, size and labels.
    """
    asserted = reasoner.about(term)
    return (
        bool(asserted)
        and may_be_individual(classes, term, asserted.get(v.RDF_TYPE, []))
        and _OF_SCHEMAS.isdisjoint(asserted)
        and classes.spatial.isdisjoint(reasoner.types(term))
        and not any(True for p in classes.edges for _ in reasoner.asserted(None, p, term))
    )


def read_individual(reasoner: Reasoner, classes: ClassTable, iri: Term) -> Entity:
    """Return an individual that is not in space, with all its asserted properties.

    Its class is the most specific asserted one. A class that the TBox does not declare has the last part of
    its IRI as name. It has no provenance, because its commits must be searched for.
    """
    about = equal_individuals.about_entity(reasoner, iri)
    asserted = about(iri)
    stated = frozenset(asserted.get(v.RDF_TYPE, ()))
    known = classes.most_specific_first(reasoner.types(iri))
    foreign = find_own_classes(classes, stated)
    types = (*(classes.names[t] for t in known if t in stated), *foreign)
    inferred = tuple(classes.names[t] for t in known if t not in stated)
    labels = [
        *sorted(entity_reading.read_references(about, asserted.get(v.HAS_PREFERRED_REFERENCE, ()))),
        *aligned_values.labels(classes.alignments, about, iri),
        *entity_reading.read_references(about, asserted.get(v.HAS_ALTERNATIVE_REFERENCE, ())),
        *aligned_values.aliases(asserted),
    ]
    label, *others = dict.fromkeys(labels) or [None]
    properties = {
        **classes.property_table.read_values(asserted),
        **classes.property_table.read_nameless(about, iri),
        **classes.property_table.read_others(about, iri),
    }
    properties.pop(SAME_AS, None)
    if names := equal_individuals.find_other_names(reasoner.equals(iri), iri):
        properties[SAME_AS] = names
    return Entity(
        name=v.entity_name(iri),
        class_=next(iter((*types, *inferred)), v.local_name(v.OWL_THING)),
        iri=v.bare(iri),
        types=(*types, *inferred),
        preferred_reference=label,
        alternative_references=tuple(filter(None, others)),
        properties=properties,
        in_space=False,
        provenance=_UNKNOWN,
        pose_provenance=_UNKNOWN,
        shape_provenance=_UNKNOWN,
        reference_provenance=_UNKNOWN,
    )


def find_own_classes(classes: ClassTable, stated: Iterable[Term]) -> list[str]:
    """Return the names of those of the asserted classes that the map uses and its TBox does not declare."""
    own = (o for o in stated if o not in classes.names and o not in _NO_KIND and o.startswith("<"))
    return sorted(map(v.local_name, own))


def find_referring(reasoner: Reasoner, iri: Term) -> dict[str, tuple[str, ...]]:
    """Return the names of what refers to an individual, by the name of the property.

    For a nameless individual, these are the names of those that refer to it.
    """
    members = frozenset(reasoner.equals(iri) or (iri,))
    found: dict[str, set[str]] = {}
    for member in members:
        for s, p, _ in reasoner.asserted(None, None, member):
            if p == v.OWL_SAME_AS:
                continue
            for named in _find_named(reasoner, s, _MAX_PATH):
                if named not in members:
                    found.setdefault(v.local_name(p), set()).add(v.entity_name(named))
    return {p: tuple(sorted(names)) for p, names in sorted(found.items())}


def _find_named(reasoner: Reasoner, term: Term, reach: int) -> Iterator[Term]:
    """Yield a term that has a name, or those that refer to a nameless one in at most `reach` steps."""
    if not term.startswith("_:"):
        yield term
    elif reach:
        for s, _, _ in reasoner.asserted(None, None, term):
            yield from _find_named(reasoner, s, reach - 1)
