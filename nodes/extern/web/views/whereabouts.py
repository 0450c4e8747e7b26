"""What every entity is on, inside and in, kept up to date by the commits."""

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
"""Asks, with inferred facts, for the rows that `Whereabouts.begin` takes.

A variable as predicate would have all that is near each other measured, which takes seconds.
"""


class Whereabouts:
    """The facts on, inside and in that hold: asserted and not denied, measured, or following from these."""

    def __init__(self) -> None:
        self._others: dict[Term, dict[Term, set[Term]]] = {relation: {} for relation in _RELATIONS}

    def begin(self, rows: Iterable[Row]) -> None:
        """Take the answer to `QUERY`, and forget all else."""
        self._others = {relation: {} for relation in _RELATIONS}
        self._add(row for row in rows if len(row) == 3)

    def take(self, commit: Commit) -> frozenset[str]:
        """Take over a commit in full; the names of the things that are elsewhere by it."""
        places = commit.places
        gone: list[Row] = [*commit.retracted]
        come: list[Row] = [*commit.inserted]
        if places is not None:
            denied = {*places.denied}
            gone += [*places.went, *denied]
            come = [*(row for row in come if row not in denied), *places.came, *places.undenied]
        touched = self._remove(gone)
        touched |= self._add(come)
        return frozenset(map(v.entity_name, touched))

    def bearer(self, entity: Entity) -> str:
        """The thing that it is inside, or else on, by name; empty where nothing is known to bear it."""
        for relation in (_INSIDE, _ON):
            if others := self._of(entity, relation):
                return min(others)
        return ""

    def room(self, entity: Entity, places: Mapping[str, Entity]) -> str:
        """The smallest of the places that it is in, by name; empty for none."""
        inside = [name for name in self._of(entity, _IN) if name in places and name != entity.name]
        return min(inside, key=lambda name: (footprint_m2(places[name]), name), default="")

    def places_of(self, entity: Entity, places: Collection[str]) -> frozenset[str]:
        """All of `places` that it is in."""
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
    """The area that a place covers; that of unknown size counts as endless."""
    return float("inf") if place.size_m is None else place.size_m[0] * place.size_m[1]
