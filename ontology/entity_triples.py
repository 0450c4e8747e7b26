"""How an entity is said in triples: its star.

    :chair1  a dm:Chair ; dm:hasPosition :chair1_coordinates ; dm:hasSize :chair1_size ;
             dm:hasPreferredReference :chair1_preferred_reference ; ...

New individuals are named after the entity, never after their text, which may hold anything.
"""

from __future__ import annotations

from functools import lru_cache

from semmap.ontology import vocabulary as v
from semmap.schemas.entities import IDENTITY, Pose, Size
from semmap.schemas.explanations import Term, Triple

DESCRIPTION_PROPERTIES = (v.HAS_POSITION, v.HAS_SIZE, v.HAS_PREFERRED_REFERENCE, v.HAS_ALTERNATIVE_REFERENCE)
"""The edges from an entity to the individuals of its star."""
COORDINATE_PROPERTIES = (*v.COORDINATE_XYZ, *v.ORIENTATION_WXYZ)
"""The numbers that say where an entity is."""
_FLOAT = f'"^^{v.XSD_FLOAT}'


def describe(
    name: str,
    class_iri: Term,
    *,
    pose: Pose | None = None,
    size_m: Size | None = None,
    preferred: str | None = None,
    alternatives: tuple[str, ...] = (),
    suffix: str = "",
) -> list[Triple]:
    """All triples of a new entity; `suffix` ends the names of the individuals that describe it."""
    entity = v.entity_iri(name)
    triples: list[Triple] = [(entity, v.RDF_TYPE, class_iri)]
    if pose is not None:
        triples += position(entity, v.entity_iri(f"{name}_coordinates{suffix}"), pose)
    if size_m is not None:
        triples += size(entity, v.entity_iri(f"{name}_size{suffix}"), size_m)
    if preferred is not None:
        triples += preferred_reference(entity, v.entity_iri(f"{name}_preferred_reference{suffix}"), preferred)
    for i, text in enumerate(alternatives, start=1):
        triples += alternative_reference(
            entity, v.entity_iri(f"{name}_alternative_reference_{i}{suffix}"), text
        )
    return triples


def position(entity: Term, node: Term, pose: Pose) -> list[Triple]:
    """Where an entity is, by the individual `node`."""
    return [(entity, v.HAS_POSITION, node), (node, v.RDF_TYPE, v.COORDINATES), *coordinates(node, pose)]


def coordinates(node: Term, pose: Pose) -> list[Triple]:
    """The numbers of a pose: position and, unless it is the identity, orientation."""
    numbers = _numbers(node, v.COORDINATE_XYZ, pose.position_m)
    if pose.orientation_wxyz != IDENTITY:
        numbers += _numbers(node, v.ORIENTATION_WXYZ, pose.orientation_wxyz)
    return numbers


def size(entity: Term, node: Term, size_m: Size) -> list[Triple]:
    """Extent along the entity's own axes."""
    return [(entity, v.HAS_SIZE, node), (node, v.RDF_TYPE, v.THREE_DIM_SIZE), *extent(node, size_m)]


def extent(node: Term, size_m: Size) -> list[Triple]:
    """The numbers of a size."""
    return _numbers(node, v.SIZE_XYZ, size_m)


def preferred_reference(entity: Term, node: Term, text: str) -> list[Triple]:
    """What people call it."""
    return [
        (entity, v.HAS_PREFERRED_REFERENCE, node),
        (node, v.RDF_TYPE, v.PREFERRED_REFERENCE),
        (node, v.LEXICAL_REFERENCE, _word(text)),
    ]


def alternative_reference(entity: Term, node: Term, text: str) -> list[Triple]:
    """What people call it, too."""
    return [
        (entity, v.HAS_ALTERNATIVE_REFERENCE, node),
        (node, v.RDF_TYPE, v.ALTERNATIVE_REFERENCE),
        (node, v.LEXICAL_REFERENCE, _word(text)),
    ]


@lru_cache(maxsize=1024)
def _word(text: str) -> Term:
    """The literal of what is said of very many things: then it is one object."""
    return v.literal(text)


def _numbers(node: Term, properties: tuple[Term, ...], values: tuple[float, ...]) -> list[Triple]:
    return [
        (node, predicate, f'"{float(value)!r}{_FLOAT}')  # a number has nothing to escape
        for predicate, value in zip(properties, values, strict=True)
    ]
