"""The trees of classes and of places, with the number of entities of each."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from typing import Any

from semmap.nodes.extern.phrasing import english
from semmap.nodes.extern.web.views.entities.locations import Locations, footprint_m2
from semmap.ontology import vocabulary as v
from semmap.schemas.entities import ClassInfo, Entity

Node = dict[str, Any]
"""A node for `ui.tree`: a unique `id`, a `label`, `children`, and the `name` of its class or place."""

_SUB_LOCATION = "hasSubLocation"
_IS_SUB_LOCATION = "isSubLocationOf"


def class_tree(
    classes: Iterable[ClassInfo], entities: Iterable[Entity], *, with_empty: bool = False
) -> list[Node]:
    """Return the classes below their parents. Classes without entities are left out, unless `with_empty`.

    A class with several parents is below each of them. Counts include inferred instances. The number of
    asserted ones is in brackets, if it is smaller.
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
    title = c.name if same or not label else f"{c.name} ({label})"
    if not inferred:
        return title
    directly = f" ({asserted} asserted)" if 0 < asserted < inferred else ""
    return f"{title} · {inferred}{directly}"


def place_tree(entities: Mapping[str, Entity], locations: Locations) -> list[Node]:
    """Return the places below the places that contain them, with the number of entities in each."""
    places = {name: entity for name, entity in entities.items() if entity.place}
    counts: Counter[str] = Counter()
    for name, entity in entities.items():
        if name not in places:
            counts.update(locations.find_places(entity, places))
    above = {name: _find_parent(place, places, locations) for name, place in places.items()}
    children: dict[str, list[str]] = {}
    for name in places:
        children.setdefault("" if _is_circular(name, above) else above[name], []).append(name)

    def grown(parent: str) -> list[Node]:
        return [
            {
                "id": name,
                "name": name,
                "label": _place_label(places[name], counts[name]),
                "children": grown(name),
            }
            for name in sorted(children.get(parent, []), key=str.casefold)
        ]

    return grown("")


def _find_parent(place: Entity, places: Mapping[str, Entity], locations: Locations) -> str:
    """Return the smallest place of which this one is an asserted sublocation, or else that contains it."""
    asserted = {name for name, other in places.items() if place.name in _stated(other, _SUB_LOCATION)}
    asserted |= {name for name in _stated(place, _IS_SUB_LOCATION) if name in places}
    wholes = (asserted or locations.find_places(place, places)) - {place.name}
    return min(wholes, key=lambda name: (footprint_m2(places[name]), name), default="")


def _stated(entity: Entity, property_: str) -> tuple[str, ...]:
    """Return the names of the individuals that are asserted values of a property."""
    stated = entity.properties.get(property_, ())
    values = stated if isinstance(stated, tuple) else (stated,)
    return tuple(v.entity_name(str(value)) for value in values)


def _is_circular(name: str, above: Mapping[str, str]) -> bool:
    """Return whether a place is, directly or indirectly, below itself."""
    seen, at = {name}, above[name]
    while at:
        if at in seen:
            return True
        seen.add(at)
        at = above.get(at, "")
    return False


def _place_label(place: Entity, things: int) -> str:
    label = place.preferred_reference
    title = f"{place.name} ({label})" if label and label != place.name else place.name
    return f"{title} · {things}" if things else title
