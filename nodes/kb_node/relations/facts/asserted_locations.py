"""Asserted facts about locations, indexed by the entities in them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

from semmap.nodes.kb_node.relations.facts.contradictions import PROPERTIES, fact_of
from semmap.nodes.kb_node.relations.facts.place_facts import Fact
from semmap.schemas.explanations import Term, Triple

_LOCATION_PROPERTIES = frozenset(PROPERTIES)


class AssertedLocations:
    """An index of the asserted triples of `contradictions.PROPERTIES`, updated with commits once built."""

    def __init__(self, asserted: Callable[[Term], Iterable[Triple]]) -> None:
        """`asserted(property)` returns the triples of a property. All are read on first access."""
        self._asserted = asserted
        self._about: dict[str, dict[Triple, Fact]] | None = None

    def __bool__(self) -> bool:
        """Return whether there is any such triple."""
        return bool(self._index())

    def about(self, names: Iterable[str]) -> dict[Triple, Fact]:
        """Return the location triples with any of these names as subject or object."""
        index = self._index()
        return {triple: fact for name in names for triple, fact in index.get(name, {}).items()}

    def change(self, gone: Iterable[Triple], come: Iterable[Triple]) -> None:
        """Apply retracted and inserted triples of any kind."""
        if self._about is None:
            return
        for triple in filter_location_triples(gone) if self._about else ():
            if (fact := fact_of(triple)) is not None:
                for name in _names(fact):
                    about = self._about.get(name, {})
                    about.pop(triple, None)
                    if not about:
                        self._about.pop(name, None)
        for triple in filter_location_triples(come):
            self._add(self._about, triple)

    def _index(self) -> dict[str, dict[Triple, Fact]]:
        if self._about is None:
            self._about = {}
            for property_ in PROPERTIES:
                for triple in self._asserted(property_):
                    self._add(self._about, triple)
        return self._about

    @staticmethod
    def _add(index: dict[str, dict[Triple, Fact]], triple: Triple) -> None:
        if (fact := fact_of(triple)) is not None:
            for name in _names(fact):
                index.setdefault(name, {})[triple] = fact


def filter_location_triples(triples: Iterable[Triple]) -> list[Triple]:
    """Return the triples that state a location."""
    return [triple for triple in triples if triple[1] in _LOCATION_PROPERTIES]


def _names(fact: Fact) -> Iterator[str]:
    yield fact[0]
    yield fact[2]
