"""Keeps the computed facts of the reasoner up to date: spatial relations that follow from poses.

Computed facts never cause a commit to be rejected. A computed fact that contradicts asserted facts is
*suppressed*. If several facts together cause the contradiction, the last one in alphabetical order is. Which
facts are suppressed depends only on the asserted facts, not on the order of the commits.

An asserted location that contradicts the geometry is suppressed, too. It is restored when the geometry agrees
again, unless it contradicts facts that were asserted since.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence, Set
from itertools import islice
from typing import NamedTuple

from semmap.nodes.kb_node.progress import split_batches
from semmap.nodes.kb_node.proofs import number_nameless
from semmap.nodes.kb_node.reasoner import Change, Inconsistent, Reasoner
from semmap.nodes.kb_node.reasoner.explain import sentences
from semmap.nodes.kb_node.reasoner.explanations import Explanation
from semmap.nodes.kb_node.relations.facts.computed_facts import ComputedFacts, Known, Step
from semmap.nodes.kb_node.relations.facts.contradictions import PROPERTIES, fact_of
from semmap.nodes.kb_node.relations.facts.place_facts import Fact
from semmap.nodes.kb_node.relations.facts.rules import COMPUTED
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from semmap.ontology import entity_triples
from semmap.ontology import vocabulary as v
from semmap.schemas.entities import Entity
from semmap.schemas.explanations import Term, Triple

_STEP = 2000
"""Entities that are compared in some tens of milliseconds."""
PART = 20_000
"""Facts that are passed to the reasoner at once, which takes some tenths of a second."""


FEW_ASIDE = 100
"""Up to this number, all suppressed facts are checked against each assertion, which takes some hundredths of
a second."""
_MEASURES = frozenset((*entity_triples.COORDINATE_PROPERTIES, *v.SIZE_XYZ, v.LEXICAL_REFERENCE))
"""Properties whose values do not relate individuals."""


class DerivedChanges(NamedTuple):
    """How the computed and suppressed facts differ from those before a commit."""

    gone: tuple[Triple, ...] = ()
    """Computed facts that do not hold any more."""
    come: tuple[Triple, ...] = ()
    aside: tuple[Triple, ...] = ()
    """Asserted facts that are suppressed."""
    back: tuple[Triple, ...] = ()

    @property
    def subjects(self) -> Iterator[str]:
        """Yield the names of the subjects; some occur more than once."""
        return (v.entity_name(triple[0]) for triples in self for triple in triples)


UNCHANGED = DerivedChanges()


class DerivedFacts:
    """Keeps the computed facts of a reasoner in step with a map."""

    def __init__(
        self,
        reasoner: Reasoner,
        limits: Thresholds | None = None,
        progress: Callable[[], None] = lambda: None,
    ) -> None:
        """Wrap `reasoner`, which holds the asserted facts.

        `progress` is called between the steps of long work.
        """
        self._reasoner = reasoner
        self._progress = progress
        self.computed = ComputedFacts(_declared(reasoner), limits)
        self.suppressed: dict[Triple, Explanation] = {}
        """Facts that contradict the rest, with the explanation."""
        self._dependents: dict[Triple, set[Triple]] = {}
        """By triple of an explanation: the facts that are suppressed because of it."""
        self._newly: dict[Triple, None] = {}
        """Facts that were suppressed since `begin`, and may have been restored again."""
        self._formerly: set[Triple] = set()
        """Facts that were suppressed at `begin` and have been checked again since."""
        self._moved: set[Term] = set()
        self._net: dict[bool, dict[Triple, bool]] = {True: {}, False: {}}
        """Computed (True) and asserted (False) triples that changed since `begin`, with whether they hold
        now."""

    def begin(self) -> None:
        """Start to record changes."""
        for net in self._net.values():
            net.clear()
        self._moved.clear()
        self._newly.clear()
        self._formerly.clear()

    @property
    def derived_changes(self) -> DerivedChanges:
        """Return the changes since `begin`."""
        if not any(self._net.values()):
            return UNCHANGED

        def those(is_computed: bool, wanted: bool) -> tuple[Triple, ...]:
            return tuple([t for t, holds in self._net[is_computed].items() if holds is wanted])

        return DerivedChanges(those(True, False), those(True, True), those(False, False), those(False, True))

    @property
    def reclassified(self) -> frozenset[Term]:
        """Return the individuals whose named classes have changed through computed facts since `begin`."""
        return frozenset(self._moved)

    def all(self) -> DerivedChanges:
        """Return all computed and all suppressed facts."""
        return DerivedChanges(come=tuple(self._reasoner.computed()), aside=tuple(self._reasoner.suppressed()))

    def change(
        self, delete: Collection[Triple], insert: Collection[Triple], *, lenient: bool = False
    ) -> Change:
        """Assert and retract triples, and suppress computed facts that contradict them.

        If `lenient`, contradicting asserted locations are suppressed, too, as they may have been before a
        restart. Raises Inconsistent, with everything as before, if no computed fact is part of the
        contradiction.
        """
        suppressed: list[Triple] = []
        insert = list(insert)
        while True:
            try:
                change = self._reasoner.apply(delete=delete, insert=insert)
            except Inconsistent as error:
                found = error.explanation
                doubtful = [t for t in found.support if self._reasoner.is_computed(t)]
                if not doubtful and lenient:
                    doubtful = [t for t in found.support if fact_of(t) is not None]
                if not doubtful:
                    self._reconsider(suppressed)
                    raise
                last = max(doubtful)
                suppressed.append(last)
                if last in insert and not self._reasoner.is_computed(last):
                    insert.remove(last)
                    self._suppress(last, found, is_there=False)
                else:
                    self._suppress(last, found)
            else:
                return change

    def require_agreement(self, inserted: Iterable[Triple]) -> None:
        """Require that new assertions do not contradict suppressed assertions, directly or in a chain.

        The geometry may deny either now, but a later change of poses, or undoing one, would restore both. The
        computed facts are as before, also if this raises Inconsistent.
        """
        if not self._reasoner.has_suppressed:
            return
        asserted = frozenset(inserted)
        given: list[Triple] = []
        gone: list[Triple] = []
        try:
            for triple in self._suppressed_about(asserted):
                if self._is_restorable(triple, asserted, gone):
                    given.append(triple)
        finally:
            if given or gone:
                self._reasoner.update_computed(suppress=given, add=gone)

    def _suppressed_about(self, asserted: Iterable[Triple]) -> list[Triple]:
        """Return the suppressed facts that may contradict triples: all of them, unless there are many.

        If there are many, these are the facts about the same individuals, about individuals related to those,
        and so on.
        """
        about = [triple for triple in asserted if triple[1] not in _MEASURES]
        suppressed = list(islice(self._reasoner.suppressed(), FEW_ASIDE + 1))
        if about and len(suppressed) <= FEW_ASIDE:
            return sorted(suppressed)
        waiting = {term for s, _, o in asserted for term in (s, o)}
        found: set[Triple] = set()
        while waiting:
            joined = self._reasoner.suppressed_about(waiting) - found
            waiting = {term for s, _, o in joined for term in (s, o)}
            found |= joined
        return sorted(found)

    def _is_restorable(self, triple: Triple, asserted: Set[Triple], gone: list[Triple]) -> bool:
        """Restore a suppressed triple, and remove computed facts that contradict it.

        The removed facts are added to `gone`. Return False if the triple contradicted the rest before. Raises
        Inconsistent if it contradicts `asserted`.
        """
        while True:
            try:
                self._reasoner.update_computed(restore=[triple])
            except Inconsistent as error:
                support = error.explanation.support
                if doubtful := [t for t in support if self._reasoner.is_computed(t)]:
                    self._reasoner.update_computed(remove=doubtful)
                    gone += doubtful
                elif asserted.isdisjoint(support):
                    return False
                else:
                    raise
            else:
                return True

    @property
    def contradicted(self) -> dict[Triple, Explanation]:
        """Return the asserted locations that are suppressed because they contradict other assertions."""
        return {t: found for t, found in self.suppressed.items() if self._is_asserted(t)}

    @property
    def suppressed_measurements(self) -> frozenset[Fact]:
        """Return the measured facts that are suppressed."""
        if not self.suppressed:
            return frozenset()
        return frozenset(
            (v.entity_name(s), COMPUTED[p], v.entity_name(o))
            for s, p, o in self.suppressed
            if p in COMPUTED and not self._is_asserted((s, p, o))
        )

    @property
    def newly_suppressed(self) -> list[Triple]:
        """Return the facts that are suppressed now and were not at `begin`."""
        return sorted(self._newly.keys() & self.suppressed.keys())

    def describe(self, fact: Triple) -> str:
        """Return a sentence that says which fact is suppressed, and why."""
        words, found = self._reasoner.words, self.suppressed[fact]
        measured = [t for t in found.support if t[1] in COMPUTED and not self._is_asserted(t)]
        clause, reason = (
            sentences.triple_clause(fact, words),
            sentences.mark_measured(found.text, measured, words),
        )
        seen = "asserted" if self._is_asserted(fact) else "measured"
        return number_nameless(
            f"'{clause}' ({seen}) is suppressed, because it would contradict the map: {reason}"
        )

    def follow(
        self,
        changed: Collection[Entity],
        removed: Collection[str],
        before: Known,
        retracted: Collection[Triple],
        inserted: Collection[Triple],
    ) -> frozenset[Term]:
        """Update the computed facts after a change of entities and assertions.

        `before` returns the entities as they were. Return the individuals whose named classes changed through
        computed facts.
        """
        if self.computed.is_idle:
            return frozenset()
        step = self.computed.after(changed, removed, before, retracted, inserted)
        if not self.computed.facts.is_complete:  # some of the new facts may be known from before the start
            step = step._replace(come={t for t in step.come if not self._reasoner.is_computed(t)})
        self._carry_out(step, retracted)
        return self.reclassified

    def fill(self, entities: Mapping[str, Entity]) -> None:
        """Derive the facts of these entities and of all that is asserted."""
        for _ in self.filling(entities):
            self._progress()

    def filling(self, entities: Mapping[str, Entity]) -> Iterator[None]:
        """Do the same in steps; nothing may change in between. The last step may take long.

        Facts that the reasoner holds from a previous map stay if they still hold.
        """
        yield from self.placing(entities)
        yield from self.comparing(entities)

    def placing(self, entities: Mapping[str, Entity]) -> Iterator[None]:
        """Compute the positions of all entities, the first half of `filling`.

        Nothing may change between the steps.
        """
        if not self.computed.is_idle:
            yield from self.computed.facts.insert_steps(entities.values())
            self.computed.placed()

    def comparing(self, entities: Mapping[str, Entity]) -> Iterator[None]:
        """Compute the facts and compare them with those of the reasoner, the second half of `filling`.

        If the reasoner held them before and no locations are asserted (`is_compared_in_steps`), `follow` may
        be called between the steps. `entities` must then be up to date.
        """
        if self.computed.is_idle:
            return
        yield from self.computed.facts.compute_steps()
        asserted = self._asserted_places()
        if self.is_compared_in_steps(asserted):
            for names in split_batches(tuple(entities), _STEP, self._progress):
                self._compare(names, entities.get)
                yield
            return
        step = self.computed.begin(entities.get, asserted)
        present, suppressed = set(self._reasoner.computed()), set(self._reasoner.suppressed())
        step = step._replace(
            come=set(step.come) - present,
            gone=present.difference(step.come),
            denied=step.denied - suppressed,
            undenied=suppressed - step.denied - self.suppressed.keys(),
        )
        for triple in suppressed & self.computed.denied:
            self._clear_suppressed(triple)
        self._carry_out(step, ())

    def is_compared_in_steps(self, said: Sequence[Triple] | None = None) -> bool:
        """Return whether the reasoner holds computed facts and no locations are asserted (`said`)."""
        if self._reasoner.has_suppressed or next(iter(self._reasoner.computed()), None) is None:
            return False
        return not (self._asserted_places() if said is None else said)

    def _asserted_places(self) -> list[Triple]:
        return [t for p in PROPERTIES for t in self._reasoner.asserted(None, p, None)]

    def _compare(self, names: Iterable[str], known: Known) -> None:
        """Update the computed facts of some entities in the reasoner."""
        subjects = {name: v.iri(entity.iri) for name in names if (entity := known(name)) is not None}
        now = self.computed.of(subjects, known)
        present = {t for iri in subjects.values() for t in self._reasoner.computed(iri)}
        self._carry_out(Step(now - present - self.suppressed.keys(), present - now, set(), set()), ())

    def _carry_out(self, step: Step, retracted: Iterable[Triple]) -> None:
        lost = [*step.gone, *step.denied, *retracted]
        for triple in (*lost, *step.undenied) if self.suppressed else ():
            self._clear_suppressed(triple)
        try:
            self._believe(gone=step.gone, come=step.come, aside=step.denied, back=step.undenied)
        except Inconsistent:
            asserted = set(filter(self._is_asserted, step.undenied))
            self._believe(gone=step.gone, aside=step.denied, back=step.undenied - asserted)
            self._believe_consistent(sorted(asserted.union(step.come), key=self._order))
        if self._dependents:
            self._reconsider(lost)

    def _believe(
        self,
        gone: Collection[Triple] = (),
        come: Collection[Triple] = (),
        aside: Collection[Triple] = (),
        back: Collection[Triple] = (),
    ) -> None:
        """Pass changes to the reasoner.

        Raises Inconsistent, with everything as before, if new facts contradict the rest.
        """
        if not (gone or come or aside or back):
            return
        if len(come) <= PART:
            self._moved.update(
                self._reasoner.update_computed(remove=gone, add=come, suppress=aside, restore=back).others
            )
        else:
            self._believe_in_parts(gone, come, aside, back)
        for triples, is_computed, holds in (
            (gone, True, False), (come, True, True), (aside, False, False), (back, False, True),
        ):  # fmt: skip
            if not triples:
                continue
            net = self._net[is_computed]
            if not net or net.keys().isdisjoint(triples):
                net.update(dict.fromkeys(triples, holds))
                continue
            for triple in triples:
                if net.setdefault(triple, holds) != holds:
                    del net[triple]

    def _believe_in_parts(
        self,
        gone: Collection[Triple],
        come: Iterable[Triple],
        aside: Collection[Triple],
        back: Collection[Triple],
    ) -> None:
        reasoner, added = self._reasoner, list[Triple]()
        self._moved.update(reasoner.update_computed(remove=gone, suppress=aside, restore=back).others)
        try:
            for part in split_batches(come, PART, self._progress):
                self._moved.update(reasoner.update_computed(add=part).others)
                added += part
        except Inconsistent:
            reasoner.update_computed(remove=added, add=gone, suppress=back, restore=aside)
            raise

    # Contradictions

    def _believe_consistent(self, facts: Sequence[Triple]) -> None:
        """Add all facts that contradict nothing, and suppress the others."""
        if not facts:
            return
        asserted = [t for t in facts if self._is_asserted(t)]
        try:
            self._believe(come=[t for t in facts if t not in asserted], back=asserted)
        except Inconsistent as error:
            if len(facts) > 1:
                half = len(facts) // 2
                self._believe_consistent(facts[:half])
                self._believe_consistent(facts[half:])
            else:
                self._resolve_conflict(facts[0], error.explanation)

    def _resolve_conflict(self, fact: Triple, found: Explanation) -> None:
        """Suppress a fact that contradicts the rest, or a less important fact of the contradiction."""
        doubtful = [t for t in found.support if self._reasoner.is_computed(t)]
        if self._is_asserted(fact):
            doubtful += [t for t in found.support if fact_of(t) is not None and t not in doubtful]
        last = max((*doubtful, fact), key=self._order)
        if last == fact:
            self._record_suppressed(fact, found)
            return
        self._suppress(last, found)
        self._believe_consistent([fact])
        self._reconsider([last])

    def _suppress(self, fact: Triple, found: Explanation, *, is_there: bool = True) -> None:
        """Remove a fact from those that hold."""
        if not is_there:
            self._reasoner.update_computed(suppress=[fact])
        elif self._reasoner.is_computed(fact):
            self._believe(gone=[fact])
        else:
            self._believe(aside=[fact])
        self._record_suppressed(fact, found)

    def _record_suppressed(self, fact: Triple, found: Explanation) -> None:
        self._clear_suppressed(fact)
        self.suppressed[fact] = found
        if fact not in self._formerly:
            self._newly[fact] = None
        for triple in found.support:
            if triple != fact:
                self._dependents.setdefault(triple, set()).add(fact)

    def _clear_suppressed(self, fact: Triple) -> None:
        """Mark a fact as not suppressed."""
        found = self.suppressed.pop(fact, None)
        if found is not None and fact not in self._newly:
            self._formerly.add(fact)
        for triple in () if found is None else found.support:
            resting = self._dependents.get(triple, set())
            resting.discard(fact)
            if not resting:
                self._dependents.pop(triple, None)

    def _reconsider(self, lost: Iterable[Triple]) -> None:
        """Check again the facts that were suppressed because of facts that do not hold any more."""
        waiting = {fact for triple in lost for fact in self._dependents.get(triple, ())}
        waiting.update(triple for triple in lost if triple in self.suppressed)
        for fact in sorted(waiting, key=self._order):
            if fact in self.suppressed:
                self._clear_suppressed(fact)
                self._believe_consistent([fact])

    def _is_asserted(self, fact: Triple) -> bool:
        """Return whether a fact is asserted."""
        return any(self._reasoner.asserted(*fact))

    def _order(self, fact: Triple) -> tuple[bool, Triple]:
        """Return a sort key.

        Of two facts in conflict the greater is suppressed: computed before asserted ones.
        """
        return (not self._is_asserted(fact), fact)


def _declared(reasoner: Reasoner) -> frozenset[Term]:
    """Return the properties that are computed and that the TBox declares."""
    return frozenset(p for p in COMPUTED if any(reasoner.asserted(p, v.RDF_TYPE, None)))
