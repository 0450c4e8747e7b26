"""What is asserted of where things are, found by whom it is about."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

from semmap.nodes.kb_node.relations.facts.contradictions import PROPERTIES, fact_of
from semmap.nodes.kb_node.relations.facts.place_facts import Fact
from semmap.schemas.explanations import Term, Triple

_SAY_WHERE = frozenset(PROPERTIES)


class AssertedLocations:
    """An index of the asserted triples of `said.PROPERTIES`; kept in step with commits once it is built."""

    def __init__(self, asserted: Callable[[Term], Iterable[Triple]]) -> None:
        """`asserted(property)` are the triples of a property; the first question asks for all."""
        self._asserted = asserted
        self._about: dict[str, dict[Triple, Fact]] | None = None

    def __bool__(self) -> bool:
        """Is there anything?"""
        return bool(self._index())

    def about(self, names: Iterable[str]) -> dict[Triple, Fact]:
        """What is said of these things' places, or of other things by way of them."""
        index = self._index()
        return {triple: fact for name in names for triple, fact in index.get(name, {}).items()}

    def change(self, gone: Iterable[Triple], come: Iterable[Triple]) -> None:
        """Triples of all kinds were retracted and inserted."""
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
    """Those that say where a thing is."""
    return [triple for triple in triples if triple[1] in _SAY_WHERE]


def _names(fact: Fact) -> Iterator[str]:
    yield fact[0]
    yield fact[2]
