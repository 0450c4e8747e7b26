"""The tree of the classes and that of the places, each with how many things there are of it, or in it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from typing import Any

from semmap.nodes.extern.phrasing import english
from semmap.nodes.extern.web.views.whereabouts import Whereabouts, footprint_m2
from semmap.ontology import vocabulary as v
from semmap.schemas.entities import ClassInfo, Entity

Node = dict[str, Any]
"""As a tree takes it: `id`, `label` and `children`. An id is unique in the tree; `name` is what it is of."""

_SUB_LOCATION = "hasSubLocation"
_IS_SUB_LOCATION = "isSubLocationOf"


def class_tree(
    classes: Iterable[ClassInfo], entities: Iterable[Entity], *, with_empty: bool = False
) -> list[Node]:
    """The classes below their parents; without those of which nothing is there, unless `with_empty`.

    A class with several parents is below each of them. Counts are by inference, with those that are said to
    be of the class itself in brackets where they are fewer.
    """
    by_name = {c.name: c for c in classes}
    asserted: Counter[str] = Counter()
    inferred: Counter[str] = Counter()
    for entity in entities:
        asserted[entity.class_] += 1
        inferred.update({*entity.types, entity.class_})
    children: dict[str, list[str]] = {}
    for c in by_name.values():
        if with_empty or inferred[c.name]:
            for parent in [p for p in c.parents if p in by_name] or [""]:
                children.setdefault(parent, []).append(c.name)

    def grown(parent: str, path: tuple[str, ...]) -> list[Node]:
        return [
            {
                "id": "/".join((*path, name)),
                "name": name,
                "label": _class_label(by_name[name], inferred[name], asserted[name]),
                "children": grown(name, (*path, name)),
            }
            for name in sorted(children.get(parent, []), key=str.casefold)
            if name not in path
        ]

    return grown("", ())


def _class_label(c: ClassInfo, inferred: int, asserted: int) -> str:
    label = english(c.labels)
    same = label.casefold().replace(" ", "_") == c.name.casefold()
    called = c.name if same or not label else f"{c.name} ({label})"
    if not inferred:
        return called
    itself = f" ({asserted} said so)" if 0 < asserted < inferred else ""
    return f"{called} · {inferred}{itself}"


def place_tree(entities: Mapping[str, Entity], whereabouts: Whereabouts) -> list[Node]:
    """The places below those that they are a part of, each with how many things are in it."""
    places = {name: entity for name, entity in entities.items() if entity.place}
    held: Counter[str] = Counter()
    for name, entity in entities.items():
        if name not in places:
            held.update(whereabouts.places_of(entity, places))
    above = {name: _whole(place, places, whereabouts) for name, place in places.items()}
    children: dict[str, list[str]] = {}
    for name in places:
        children.setdefault("" if _is_circular(name, above) else above[name], []).append(name)

    def grown(parent: str) -> list[Node]:
        return [
            {
                "id": name,
                "name": name,
                "label": _place_label(places[name], held[name]),
                "children": grown(name),
            }
            for name in sorted(children.get(parent, []), key=str.casefold)
        ]

    return grown("")


def _whole(place: Entity, places: Mapping[str, Entity], whereabouts: Whereabouts) -> str:
    """The smallest place that this one is said to be a part of, or is in."""
    said = {name for name, other in places.items() if place.name in _stated(other, _SUB_LOCATION)}
    said |= {name for name in _stated(place, _IS_SUB_LOCATION) if name in places}
    wholes = (said or whereabouts.places_of(place, places)) - {place.name}
    return min(wholes, key=lambda name: (footprint_m2(places[name]), name), default="")


def _stated(entity: Entity, property_: str) -> tuple[str, ...]:
    """The individuals that a property relates it to, by name."""
    stated = entity.properties.get(property_, ())
    values = stated if isinstance(stated, tuple) else (stated,)
    return tuple(v.entity_name(str(value)) for value in values)


def _is_circular(name: str, above: Mapping[str, str]) -> bool:
    """Whether it is, by way of others, a part of itself."""
    seen, at = {name}, above[name]
    while at:
        if at in seen:
            return True
        seen.add(at)
        at = above.get(at, "")
    return False


def _place_label(place: Entity, things: int) -> str:
    called = place.preferred_reference
    named = f"{place.name} ({called})" if called and called != place.name else place.name
    return f"{named} · {things}" if things else named
