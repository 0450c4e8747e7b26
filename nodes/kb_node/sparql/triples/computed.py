"""Where things are: the facts that their poses tell, and what these deny of what is asserted."""

from __future__ import annotations

from collections.abc import Iterable, Set
from typing import Final, NamedTuple

from nodes.kb_node.relations.place_facts import Fact, Facts
from nodes.kb_node.relations.placed import Placed
from nodes.kb_node.relations.said import denial, fact_of
from ontology import vocabulary as v
from schemas.explanations import Term, Triple


class Step(NamedTuple):
    """What a commit does: computed facts come and go, asserted ones are denied or no longer."""

    come: set[Triple]
    gone: set[Triple]
    denied: set[Triple]
    undenied: set[Triple]


class Computed:
    """Follows poses and what is said of places."""

    def __init__(self, properties: Set[Term]) -> None:
        """`properties` are those that the TBox has: of others nothing is computed."""
        self._properties: Final = properties
        self._facts = Facts()
        self._iris: dict[str, Term] = {}
        self._triples: dict[Fact, Triple] = {}
        self._said: dict[str, dict[Triple, None]] = {}
        """By the names that a triple is about."""
        self._denied: set[Triple] = set()
        self._all: set[Triple] = set()

    @property
    def all(self) -> Set[Triple]:
        """All that is computed."""
        return self._all

    def is_believed(self, triple: Triple) -> bool:
        """Whether it is asserted, says where something is, and is not denied."""
        fact = fact_of(triple)
        return fact is not None and triple in self._said.get(fact[0], ()) and triple not in self._denied

    def is_denied(self, triple: Triple) -> bool:
        """Whether it is asserted and not so."""
        return triple in self._denied

    def after(
        self,
        changed: Iterable[Placed],
        removed: Iterable[str],
        retracted: Iterable[Triple],
        inserted: Iterable[Triple],
    ) -> Step:
        """A commit: entities that are otherwise now or went, and what of the triples is asserted."""
        changed, removed = tuple(changed), tuple(removed)
        gone, come = self._facts.update(changed, removed)
        touched = {*removed, *(placed.name for placed in changed)}
        self._iris.update((placed.name, v.iri(placed.iri)) for placed in changed)
        came = self._as_triples(gone, come)
        for name in removed:
            self._iris.pop(name, None)
        looked_at = self._take_up(retracted, inserted)
        for name in self._facts.upward(touched.union(fact[0] for fact in gone | come)):
            looked_at.update(self._said.get(name, ()))
        for name in touched:
            looked_at.update(self._said.get(name, ()))
        denied = {triple for triple in looked_at if self._is_so_no_more(triple)}
        newly, no_longer = denied - self._denied, (looked_at & self._denied) - denied
        self._denied |= newly
        self._denied -= no_longer
        return Step(*came, newly, no_longer)

    def _as_triples(self, gone: Set[Fact], come: Set[Fact]) -> tuple[set[Triple], set[Triple]]:
        """The triples that come, and those that go."""
        went = {t for fact in gone if (t := self._triples.pop(fact, None)) is not None}
        came: set[Triple] = set()
        for fact in come:
            name, relation, other = fact
            property_ = v.dm(relation)
            if property_ in self._properties:
                self._triples[fact] = triple = (self._iris[name], property_, self._iris[other])
                came.add(triple)
        self._all -= went
        self._all |= came
        return came - went, went - came

    def _take_up(self, retracted: Iterable[Triple], inserted: Iterable[Triple]) -> set[Triple]:
        """Remember what is said of places, and forget what is not any more; all of that."""
        concerned: set[Triple] = set()
        for triple in retracted:
            if (fact := fact_of(triple)) is not None:
                concerned.add(triple)
                for name in (fact[0], fact[2]):
                    self._said.get(name, {}).pop(triple, None)
        for triple in inserted:
            if (fact := fact_of(triple)) is not None:
                concerned.add(triple)
                for name in (fact[0], fact[2]):
                    self._said.setdefault(name, {})[triple] = None
        return concerned

    def _is_so_no_more(self, triple: Triple) -> bool:
        """Whether it is asserted of two entities, and geometry denies it."""
        fact = fact_of(triple)
        if fact is None or triple not in self._said.get(fact[0], ()):
            return False
        if {self._iris.get(fact[0]), self._iris.get(fact[2])} != {triple[0], triple[2]}:
            return False
        return denial(self._facts.space, fact) is not None
