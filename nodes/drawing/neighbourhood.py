"""Readable parts of the knowledge graph: the neighbourhood of entities, or all of it by places or classes.

The full graph of a home is not readable, so it is never drawn.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from typing import Final, Literal, NamedTuple

from semmap.schemas.entities import Entity

Relations = Mapping[str, Iterable[tuple[str, str]]]
"""By the name of an entity: a property and the name of the object entity."""
Kind = Literal["centre", "entity", "place", "class", "more"]

LOCATED_IN: Final = "isLocatedIn"
_CENTRES: Final = 12
"""Maximum number of entities whose neighbourhood is drawn; for more, the graph is drawn by places."""
_FEW: Final = 14
"""Maximum number of neighbours of an entity in one direction; others are counted."""
_MOST: Final = 60


class GraphNode(NamedTuple):
    """A node of the drawn graph. The `id` of an entity is its name; other ids contain a colon.

    `hidden` is how many further entities it stands for.
    """

    id: str
    label: str
    kind: Kind
    class_: str
    hidden: int = 0


class GraphEdge(NamedTuple):
    """An edge between two nodes; `label` holds the properties, separated by commas."""

    source: str
    target: str
    label: str


class Neighbourhood(NamedTuple):
    """A graph small enough to read."""

    knots: tuple[GraphNode, ...] = ()
    links: tuple[GraphEdge, ...] = ()


def around(
    centres: Iterable[str],
    entities: Mapping[str, Entity],
    relations: Relations,
    *,
    unfolded: Iterable[str] = (),
    few: int = _FEW,
) -> Neighbourhood:
    """Return these entities with their classes and neighbours.

    `unfolded` entities, if shown, are shown with their own neighbours. More than `few` neighbours of a kind
    are replaced by one node with their number.
    """
    shown = [name for name in dict.fromkeys(centres) if name in entities][:_CENTRES]
    drawing = _Drawing(entities)
    for name in shown:
        drawing.centre(name)
    incoming = _incoming(entities, relations)
    wider = dict.fromkeys(unfolded)
    for name in (*shown, *(name for name in wider if name not in shown)):
        if not drawing.has(name):
            continue
        limit = few if name not in wider else 4 * few
        drawing.neighbours(name, _grouped(relations.get(name, ()), entities), limit, outgoing=True)
        drawing.neighbours(name, incoming.get(name, {}), limit, outgoing=False)
    return drawing.drawn


def by_place(entities: Mapping[str, Entity], relations: Relations) -> Neighbourhood:
    """Return the places, the number of things in each, and how they are connected.

    Without places, returns the classes with their numbers.
    """
    places = {name: entity for name, entity in entities.items() if entity.place}
    if not places:
        return by_class(entities)
    number: Counter[str] = Counter()
    elsewhere = 0
    for name, entity in entities.items():
        if entity.place:
            continue
        around_it = _smallest_around(name, places, relations)
        if around_it is None:
            elsewhere += 1
        else:
            number[around_it] += 1
    shown = sorted(places, key=lambda name: (-number[name], name))[:_MOST]
    knots = [_place_knot(places[name], number[name]) for name in shown]
    if elsewhere:
        knots.append(GraphNode("more:elsewhere", f"{elsewhere} elsewhere", "more", "", elsewhere))
    return Neighbourhood(tuple(knots), _links(_between_places(shown, places, relations)))


def by_class(entities: Mapping[str, Entity], unfolded: Iterable[str] = ()) -> Neighbourhood:
    """Return the classes of the map with their number of entities; `unfolded` classes list these."""
    number = Counter(entity.class_ for entity in entities.values())
    shown = [class_ for class_, _ in sorted(number.items(), key=lambda item: (-item[1], item[0]))[:_MOST]]
    knots = [GraphNode(_class_id(c), f"{c} ({number[c]})", "class", c, number[c]) for c in shown]
    links = []
    for class_ in dict.fromkeys(unfolded):
        members = sorted(name for name, entity in entities.items() if entity.class_ == class_)
        if class_ not in shown:
            continue
        for name in members[:_MOST]:
            knots.append(GraphNode(name, name, "entity", class_))
            links.append(GraphEdge(name, _class_id(class_), "is a"))
        if len(members) > _MOST:
            more = _more(_class_id(class_), len(members) - _MOST)
            knots.append(more)
            links.append(GraphEdge(more.id, _class_id(class_), ""))
    return Neighbourhood(tuple(knots), tuple(links))


def _between_places(
    shown: Sequence[str], places: Mapping[str, Entity], relations: Relations
) -> dict[tuple[str, str], set[str]]:
    """Return each place's smallest enclosing place, and other relations between adjacent places once."""
    pairs: dict[tuple[str, str], set[str]] = {}
    within = {
        frozenset((name, other))
        for name in shown
        for prop, other in relations.get(name, ())
        if prop == LOCATED_IN
    }
    for name in shown:
        around_it = _smallest_around(name, places, relations)
        if around_it in shown:
            pairs[(name, str(around_it))] = {LOCATED_IN}
        for prop, other in relations.get(name, ()):
            pair = (other, name) if (other, name) in pairs else (name, other)
            if other in shown and other != name and frozenset(pair) not in within:
                pairs.setdefault(pair, set()).add(prop)
    return pairs


def _smallest_around(name: str, places: Mapping[str, Entity], relations: Relations) -> str | None:
    around_it = [p for prop, p in relations.get(name, ()) if prop == LOCATED_IN and p in places and p != name]
    return min(around_it, key=lambda place: (_floor_m2(places[place]), place), default=None)


def _place_knot(place: Entity, number: int) -> GraphNode:
    label = place.preferred_reference or place.name
    return GraphNode(place.name, f"{label} ({number})" if number else label, "place", place.class_, number)


class _Drawing:
    """A neighbourhood under construction, with each node and edge once."""

    def __init__(self, entities: Mapping[str, Entity]) -> None:
        self._entities = entities
        self._knots: dict[str, GraphNode] = {}
        self._pairs: dict[tuple[str, str], set[str]] = {}

    @property
    def drawn(self) -> Neighbourhood:
        return Neighbourhood(tuple(self._knots.values()), _links(self._pairs))

    def has(self, name: str) -> bool:
        return name in self._knots

    def centre(self, name: str) -> None:
        class_ = self._entities[name].class_
        self._knots[name] = GraphNode(name, name, "centre", class_)
        self._knots.setdefault(_class_id(class_), GraphNode(_class_id(class_), class_, "class", class_))
        self._pairs.setdefault((name, _class_id(class_)), set()).add("is a")

    def neighbours(
        self, name: str, others: Mapping[str, Sequence[str]], limit: int, *, outgoing: bool
    ) -> None:
        ordered = sorted(others, key=lambda other: (other not in self._knots, other))
        fits = len(ordered) <= limit
        for other in ordered if fits else ordered[: limit - 1]:
            self._knots.setdefault(other, self._entity(other))
            pair = (name, other) if outgoing else (other, name)
            self._pairs.setdefault(pair, set()).update(others[other])
        if not fits:
            more = _more(f"{name}:{'out' if outgoing else 'in'}", len(ordered) - limit + 1)
            self._knots[more.id] = more
            self._pairs[(name, more.id) if outgoing else (more.id, name)] = set()

    def _entity(self, name: str) -> GraphNode:
        entity = self._entities[name]
        return GraphNode(name, name, "place" if entity.place else "entity", entity.class_)


def _incoming(entities: Mapping[str, Entity], relations: Relations) -> dict[str, dict[str, list[str]]]:
    found: dict[str, dict[str, list[str]]] = {}
    for name in entities:
        for prop, other in relations.get(name, ()):
            if other in entities and other != name:
                found.setdefault(other, {}).setdefault(name, []).append(prop)
    return found


def _grouped(related: Iterable[tuple[str, str]], entities: Mapping[str, Entity]) -> dict[str, list[str]]:
    found: dict[str, list[str]] = {}
    for prop, other in related:
        if other in entities:
            found.setdefault(other, []).append(prop)
    return found


def _links(pairs: Mapping[tuple[str, str], Iterable[str]]) -> tuple[GraphEdge, ...]:
    return tuple(
        GraphEdge(source, target, ", ".join(sorted(prop))) for (source, target), prop in pairs.items()
    )


def _more(of: str, number: int) -> GraphNode:
    return GraphNode(f"more:{of}", f"{number} more", "more", "", number)


def _class_id(class_: str) -> str:
    return f"class:{class_}"


def _floor_m2(place: Entity) -> float:
    return place.size_m[0] * place.size_m[1] if place.size_m is not None else float("inf")
