"""Example SPARQL queries with the classes, places and entities of the current map."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from typing import Final, NamedTuple

from semmap.ontology import vocabulary as v
from semmap.schemas.entities import ClassInfo, Entity

FIRST: Final = (
    "SELECT ?thing ?class WHERE {\n  ?thing a ?class ; dm:hasPosition ?position .\n}\nORDER BY ?thing"
)


class Example(NamedTuple):
    """A query with a title; with `inferred` it needs inferred and computed facts."""

    title: str
    query: str
    inferred: bool = False


def example_queries(entities: Mapping[str, Entity], classes: Mapping[str, ClassInfo]) -> tuple[Example, ...]:
    """Return the examples that have results in this map; the first lists all entities."""
    return tuple(_examples(entities, classes))


def _examples(entities: Mapping[str, Entity], classes: Mapping[str, ClassInfo]) -> Iterator[Example]:
    yield Example("All entities with their classes", FIRST)
    things = [entity for entity in entities.values() if not entity.place]
    if things:
        yield Example(
            "Positions",
            "SELECT ?thing ?x ?y ?z WHERE {\n"
            "  ?thing dm:hasPosition ?position .\n"
            "  ?position dm:float_coordinates_x ?x ;\n"
            "            dm:float_coordinates_y ?y ;\n"
            "            dm:float_coordinates_z ?z .\n"
            "}\nORDER BY ?thing",
        )
        yield Example(
            "Number of entities per class",
            "SELECT ?class (COUNT(?thing) AS ?number) WHERE {\n"
            "  ?thing a ?class ; dm:hasPosition ?position .\n"
            "}\nGROUP BY ?class\nORDER BY DESC(?number) ?class",
        )
        yield Example(
            "Objects and their supports",
            "SELECT ?thing ?support WHERE {\n  ?thing dm:isOn ?support .\n}\nORDER BY ?support ?thing",
            inferred=True,
        )
    if (place := next((e for e in _most_common(entities) if e.place), None)) is not None:
        yield Example(
            f"Entities in {place.preferred_reference or place.name}",
            f"SELECT ?thing WHERE {{\n  ?thing dm:isLocatedIn {v.iri(place.iri)} .\n}}\nORDER BY ?thing",
            inferred=True,
        )
    if (wide := _wide_class(things, classes)) is not None:
        yield Example(
            f"Instances of {wide.name} and its subclasses",
            f"SELECT ?thing WHERE {{\n  ?thing a {v.iri(wide.iri)} .\n}}\nORDER BY ?thing",
            inferred=True,
        )
    if (some := next(iter(things), None)) is not None:
        yield Example(f"Facts about {some.name}", f"DESCRIBE {v.iri(some.iri)}")


def _most_common(entities: Mapping[str, Entity]) -> list[Entity]:
    """Return the entities, those of the most frequent class first, then by name."""
    number = Counter(entity.class_ for entity in entities.values())
    return sorted(entities.values(), key=lambda e: (-number[e.class_], e.name))


def _wide_class(things: list[Entity], classes: Mapping[str, ClassInfo]) -> ClassInfo | None:
    """Return the class with the most instances that are inferred only."""
    number = Counter(
        name for thing in things for name in thing.types if name != thing.class_ and name in classes
    )
    spread = [(count, name) for name, count in number.items() if count < len(things)]
    return classes[max(spread)[1]] if spread else None
