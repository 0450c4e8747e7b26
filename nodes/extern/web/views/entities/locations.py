"""The support, container and places of every entity, updated by commits."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from typing import Final

from semmap.ontology import vocabulary as v
from semmap.schemas.commits import Commit
from semmap.schemas.entities import Entity
from semmap.schemas.explanations import Term
from semmap.schemas.sparql import Row

_ON: Final = v.dm("isOn")
_INSIDE: Final = v.dm("isInside")
_IN: Final = v.dm("isLocatedIn")
_RELATIONS: Final = frozenset((_ON, _INSIDE, _IN))

QUERY: Final = "SELECT ?thing ?relation ?other WHERE {{ {} }}".format(
    " UNION ".join(f"{{ ?thing {p} ?other BIND({p} AS ?relation) }}" for p in (_ON, _INSIDE, _IN))
)
"""The rows that `Locations.reset` takes; to be run with inferred facts.

It has no variable predicate, because that would make the knowledge base measure all distances, which takes
seconds.
"""


class Locations:
    """The `isOn`, `isInside` and `isLocatedIn` facts that hold.

    They are asserted and not denied, computed, or inferred from these.
    """

    def __init__(self) -> None:
        self._others: dict[Term, dict[Term, set[Term]]] = {relation: {} for relation in _RELATIONS}

    def reset(self, rows: Iterable[Row]) -> None:
        """Replace all facts by the result rows of `QUERY`."""
        self._others = {relation: {} for relation in _RELATIONS}
        self._add(row for row in rows if len(row) == 3)

    def apply(self, commit: Commit) -> frozenset[str]:
        """Apply an unabridged commit, and return the names of the entities whose facts changed."""
        places = commit.places
        removed: list[Row] = [*commit.retracted]
        added: list[Row] = [*commit.inserted]
        if places is not None:
            denied = {*places.denied}
            removed += [*places.went, *denied]
            added = [*(row for row in added if row not in denied), *places.came, *places.undenied]
        changed = self._remove(removed)
        changed |= self._add(added)
        return frozenset(map(v.entity_name, changed))

    def find_support(self, entity: Entity) -> str:
        """Return the name of its container or else its support; empty if neither is known."""
        for relation in (_INSIDE, _ON):
            if others := self._of(entity, relation):
                return min(others)
        return ""

    def find_room(self, entity: Entity, places: Mapping[str, Entity]) -> str:
        """Return the name of the smallest place that contains it; empty if there is none."""
        inside = [name for name in self._of(entity, _IN) if name in places and name != entity.name]
        return min(inside, key=lambda name: (footprint_m2(places[name]), name), default="")

    def find_places(self, entity: Entity, places: Collection[str]) -> frozenset[str]:
        """Return those of `places` that contain it."""
        return frozenset(name for name in self._of(entity, _IN) if name in places)

    def _of(self, entity: Entity, relation: Term) -> list[str]:
        return [v.entity_name(other) for other in self._others[relation].get(v.iri(entity.iri), ())]

    def _add(self, rows: Iterable[Row]) -> set[Term]:
        touched: set[Term] = set()
        for thing, relation, other in rows:
            if relation in _RELATIONS and thing is not None and other is not None:
                self._others[relation].setdefault(thing, set()).add(other)
                touched.add(thing)
        return touched

    def _remove(self, rows: Iterable[Row]) -> set[Term]:
        touched: set[Term] = set()
        for thing, relation, other in rows:
            if relation in _RELATIONS and thing is not None and other is not None:
                self._others[relation].get(thing, set()).discard(other)
                touched.add(thing)
        return touched


def footprint_m2(place: Entity) -> float:
    """Return the area of a place; infinity if its size is unknown."""
    return float("inf") if place.size_m is None else place.size_m[0] * place.size_m[1]
