"""Examples of SPARQL queries about the map as it is: of its own classes, places and things."""

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
    """A query with what it asks in words; with `inferred` it needs what follows and what is computed."""

    title: str
    query: str
    inferred: bool = False


def examples(entities: Mapping[str, Entity], classes: Mapping[str, ClassInfo]) -> tuple[Example, ...]:
    """Those that have something to find in this map; the first lists it."""
    return tuple(_examples(entities, classes))


def _examples(entities: Mapping[str, Entity], classes: Mapping[str, ClassInfo]) -> Iterator[Example]:
    yield Example("Everything with its class", FIRST)
    things = [entity for entity in entities.values() if not entity.place]
    if things:
        yield Example(
            "Where things are",
            "SELECT ?thing ?x ?y ?z WHERE {\n"
            "  ?thing dm:hasPosition ?position .\n"
            "  ?position dm:float_coordinates_x ?x ;\n"
            "            dm:float_coordinates_y ?y ;\n"
            "            dm:float_coordinates_z ?z .\n"
            "}\nORDER BY ?thing",
        )
        yield Example(
            "How many there are of each class",
            "SELECT ?class (COUNT(?thing) AS ?number) WHERE {\n"
            "  ?thing a ?class ; dm:hasPosition ?position .\n"
            "}\nGROUP BY ?class\nORDER BY DESC(?number) ?class",
        )
        yield Example(
            "What stands on what",
            "SELECT ?thing ?bearer WHERE {\n  ?thing dm:isOn ?bearer .\n}\nORDER BY ?bearer ?thing",
            inferred=True,
        )
    if (place := next((e for e in _most_common(entities) if e.place), None)) is not None:
        yield Example(
            f"What is in {place.preferred_reference or place.name}",
            f"SELECT ?thing WHERE {{\n  ?thing dm:isLocatedIn {v.iri(place.iri)} .\n}}\nORDER BY ?thing",
            inferred=True,
        )
    if (wide := _wide_class(things, classes)) is not None:
        yield Example(
            f"All of class {wide.name}, subclasses included",
            f"SELECT ?thing WHERE {{\n  ?thing a {v.iri(wide.iri)} .\n}}\nORDER BY ?thing",
            inferred=True,
        )
    if (some := next(iter(things), None)) is not None:
        yield Example(f"All that is said of {some.name}", f"DESCRIBE {v.iri(some.iri)}")


def _most_common(entities: Mapping[str, Entity]) -> list[Entity]:
    """Of the commonest class first, then by name."""
    number = Counter(entity.class_ for entity in entities.values())
    return sorted(entities.values(), key=lambda e: (-number[e.class_], e.name))


def _wide_class(things: list[Entity], classes: Mapping[str, ClassInfo]) -> ClassInfo | None:
    """The class with most entities that are so by inference only."""
    number = Counter(
        name for thing in things for name in thing.types if name != thing.class_ and name in classes
    )
    spread = [(count, name) for name, count in number.items() if count < len(things)]
    return classes[max(spread)[1]] if spread else None
