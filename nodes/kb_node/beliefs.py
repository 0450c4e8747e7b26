"""What the reasoner holds to be so beyond what is asserted: where things are, as their poses tell.

Computed facts never refuse a commit. One that contradicts what is asserted is *withheld*, and of several that
together contradict it, the last in alphabetical order. Which are withheld is a function of what is asserted
alone, whatever the order of the commits. What somebody asserted of a place, and is not so, is *set aside*.
When it is so again it comes back, unless it contradicts what was asserted since: then it is withheld, too.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence, Set
from itertools import islice
from typing import NamedTuple

from semmap.nodes.kb_node.progress import parts
from semmap.nodes.kb_node.reasoner import Change, Inconsistent, Reasoner
from semmap.nodes.kb_node.reasoner.explain import sentences
from semmap.nodes.kb_node.reasoner.explanations import Explanation
from semmap.nodes.kb_node.relations.facts.computed import Computed, Known, Step
from semmap.nodes.kb_node.relations.facts.place_facts import Fact
from semmap.nodes.kb_node.relations.facts.rules import COMPUTED
from semmap.nodes.kb_node.relations.facts.said import PROPERTIES, fact_of
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from semmap.ontology import entity_triples
from semmap.ontology import vocabulary as v
from semmap.schemas.entities import Entity
from semmap.schemas.explanations import Term, Triple

_STEP = 2000
"""Entities that are compared in some tens of milliseconds."""
PART = 20_000
"""Facts that the reasoner takes in at once, in some tenths of a second."""


FEW_ASIDE = 100
"""What is set aside: so much is looked at for whatever is asserted, some hundredths of a second."""
_MEASURES = frozenset((*entity_triples.COORDINATE_PROPERTIES, *v.SIZE_XYZ, v.LEXICAL_REFERENCE))
"""What is asserted by these joins no individuals."""


class Believed(NamedTuple):
    """How the reasoner's beliefs differ from those before a commit, besides what the commit asserts."""

    gone: tuple[Triple, ...] = ()
    """Computed facts."""
    come: tuple[Triple, ...] = ()
    aside: tuple[Triple, ...] = ()
    """Asserted facts that do not hold."""
    back: tuple[Triple, ...] = ()

    @property
    def subjects(self) -> Iterator[str]:
        """The names of those that they are about; some more than once."""
        return (v.entity_name(triple[0]) for triples in self for triple in triples)


UNCHANGED = Believed()


class Beliefs:
    """Keeps a reasoner's beliefs in step with a map."""

    def __init__(
        self,
        reasoner: Reasoner,
        limits: Thresholds | None = None,
        progress: Callable[[], None] = lambda: None,
    ) -> None:
        """`reasoner` holds what is asserted; `progress` is called between the steps of long work."""
        self._reasoner = reasoner
        self._progress = progress
        self.computed = Computed(_declared(reasoner), limits)
        self.withheld: dict[Triple, Explanation] = {}
        """Facts that contradict the rest, and how."""
        self._rests: dict[Triple, set[Triple]] = {}
        """By a triple of an explanation, who is withheld because of it."""
        self._newly: dict[Triple, None] = {}
        """What was withheld since `begin`, and may not be any more."""
        self._formerly: set[Triple] = set()
        """What was withheld at `begin`, and has been looked at again since."""
        self._moved: set[Term] = set()
        self._net: dict[bool, dict[Triple, bool]] = {True: {}, False: {}}
        """Of computed triples, and of asserted ones, that came or went since `begin`: do they hold now?"""

    def begin(self) -> None:
        """What differs is counted from here on."""
        for net in self._net.values():
            net.clear()
        self._moved.clear()
        self._newly.clear()
        self._formerly.clear()

    @property
    def believed(self) -> Believed:
        """What differs since `begin`."""
        if not any(self._net.values()):
            return UNCHANGED

        def those(is_computed: bool, wanted: bool) -> tuple[Triple, ...]:
            return tuple([t for t, holds in self._net[is_computed].items() if holds is wanted])

        return Believed(those(True, False), those(True, True), those(False, False), those(False, True))

    def all(self) -> Believed:
        """All that is computed or set aside."""
        return Believed(come=tuple(self._reasoner.computed()), aside=tuple(self._reasoner.set_aside()))

    def change(
        self, delete: Collection[Triple], insert: Collection[Triple], *, lenient: bool = False
    ) -> Change:
        """Let the reasoner assert and retract; computed facts that are in the way are withheld.

        When it is `lenient`, so is what is asserted of places, which may be there because it was set aside
        before a restart. Raises Inconsistent, with everything as it was, when nothing computed is in the way.
        """
        withheld: list[Triple] = []
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
                    self._reconsider(withheld)
                    raise
                last = max(doubtful)
                withheld.append(last)
                if last in insert and not self._reasoner.is_computed(last):
                    insert.remove(last)
                    self._withhold(last, found, is_there=False)
                else:
                    self._withhold(last, found)
            else:
                return change

    def require_agreement(self, inserted: Iterable[Triple]) -> None:
        """What was just asserted must not contradict what is asserted and set aside, directly or in a chain.

        Geometry may deny either, but a later change of poses, or taking one back, would bring both together.
        The reasoner's beliefs are as before, also when this raises Inconsistent.
        """
        if not self._reasoner.sets_aside:
            return
        asserted = frozenset(inserted)
        given: list[Triple] = []
        gone: list[Triple] = []
        try:
            for triple in self._aside_about(asserted):
                if self._is_given_back(triple, asserted, gone):
                    given.append(triple)
        finally:
            if given or gone:
                self._reasoner.believe(aside=given, come=gone)

    def _aside_about(self, asserted: Iterable[Triple]) -> list[Triple]:
        """What is set aside and may contradict triples: all of it, as long as that is not much.

        Of very much it is what is about the same individuals, about those that this is about, and so on.
        """
        about = [triple for triple in asserted if triple[1] not in _MEASURES]
        aside = list(islice(self._reasoner.set_aside(), FEW_ASIDE + 1))
        if about and len(aside) <= FEW_ASIDE:
            return sorted(aside)
        waiting = {term for s, _, o in asserted for term in (s, o)}
        found: set[Triple] = set()
        while waiting:
            joined = self._reasoner.set_aside_about(waiting) - found
            waiting = {term for s, _, o in joined for term in (s, o)}
            found |= joined
        return sorted(found)

    def _is_given_back(self, triple: Triple, asserted: Set[Triple], gone: list[Triple]) -> bool:
        """Let a triple hold that is set aside, without the computed facts that are in its way (`gone`).

        False when it contradicted the rest before. Raises Inconsistent for one that contradicts `asserted`.
        """
        while True:
            try:
                self._reasoner.believe(back=[triple])
            except Inconsistent as error:
                support = error.explanation.support
                if doubtful := [t for t in support if self._reasoner.is_computed(t)]:
                    self._reasoner.believe(gone=doubtful)
                    gone += doubtful
                elif asserted.isdisjoint(support):
                    return False
                else:
                    raise
            else:
                return True

    @property
    def contradicted(self) -> dict[Triple, Explanation]:
        """What is asserted of places and withheld, as it contradicts other assertions."""
        return {t: found for t, found in self.withheld.items() if self._is_said(t)}

    @property
    def left_out(self) -> frozenset[Fact]:
        """What is measured and withheld."""
        if not self.withheld:
            return frozenset()
        return frozenset(
            (v.entity_name(s), COMPUTED[p], v.entity_name(o))
            for s, p, o in self.withheld
            if p in COMPUTED and not self._is_said((s, p, o))
        )

    @property
    def newly_withheld(self) -> list[Triple]:
        """What is withheld and was not at `begin`."""
        return sorted(self._newly.keys() & self.withheld.keys())

    def told(self, fact: Triple) -> str:
        """What is withheld, and why, in a sentence."""
        words, found = self._reasoner.words, self.withheld[fact]
        measured = [t for t in found.support if t[1] in COMPUTED and not self._is_said(t)]
        clause, reason = sentences.said(fact, words), sentences.as_measured(found.text, measured, words)
        seen = "asserted" if self._is_said(fact) else "measured"
        return f"that {clause} ({seen}) would contradict the map, so it is left out: {reason}"

    def follow(
        self,
        changed: Collection[Entity],
        removed: Collection[str],
        before: Known,
        retracted: Collection[Triple],
        inserted: Collection[Triple],
    ) -> frozenset[Term]:
        """Entities and assertions are otherwise: whose named classes changed by what is computed now.

        `before` knows the entities as they were.
        """
        if self.computed.is_idle:
            return frozenset()
        step = self.computed.after(changed, removed, before, retracted, inserted)
        if not self.computed.facts.are_worked_out:  # and what comes may have been there before the start
            step = step._replace(come={t for t in step.come if not self._reasoner.is_computed(t)})
        self._carry_out(step, retracted)
        return frozenset(self._moved)

    def fill(self, entities: Mapping[str, Entity]) -> None:
        """Begin with these entities, and all that is asserted."""
        for _ in self.filling(entities):
            self._progress()

    def filling(self, entities: Mapping[str, Entity]) -> Iterator[None]:
        """The same in steps, between which nothing changes; the last may take long.

        What the reasoner has already, of a map before, stays if it is so.
        """
        yield from self.placing(entities)
        yield from self.comparing(entities)

    def placing(self, entities: Mapping[str, Entity]) -> Iterator[None]:
        """The first half of `filling`: where everything is, between whose steps nothing changes."""
        if not self.computed.is_idle:
            yield from self.computed.facts.placing(entities.values())
            self.computed.placed()

    def comparing(self, entities: Mapping[str, Entity]) -> Iterator[None]:
        """The second half: what follows from that, compared with what the reasoner has.

        If it had that before, and nobody asserts where things are (`is_compared_in_steps`), `follow` may be
        called between the steps; it is told of each entity that is otherwise, by `entities` too.
        """
        if self.computed.is_idle:
            return
        yield from self.computed.facts.working_out()
        said = self._said_of_places()
        if self.is_compared_in_steps(said):
            for names in parts(tuple(entities), _STEP, self._progress):
                self._compare(names, entities.get)
                yield
            return
        step = self.computed.begin(entities.get, said)
        there, aside = set(self._reasoner.computed()), set(self._reasoner.set_aside())
        step = step._replace(
            come=set(step.come) - there,
            gone=there.difference(step.come),
            denied=step.denied - aside,
            undenied=aside - step.denied - self.withheld.keys(),
        )
        for triple in aside & self.computed.denied:
            self._admit(triple)
        self._carry_out(step, ())

    def is_compared_in_steps(self, said: Sequence[Triple] | None = None) -> bool:
        """Whether the reasoner has what was computed, and nothing is asserted of places (`said`)."""
        if self._reasoner.sets_aside or next(iter(self._reasoner.computed()), None) is None:
            return False
        return not (self._said_of_places() if said is None else said)

    def _said_of_places(self) -> list[Triple]:
        return [t for p in PROPERTIES for t in self._reasoner.asserted(None, p, None)]

    def _compare(self, names: Iterable[str], known: Known) -> None:
        """Let the reasoner believe of some entities what is computed of them now."""
        subjects = {name: v.iri(entity.iri) for name in names if (entity := known(name)) is not None}
        now = self.computed.of(subjects, known)
        there = {t for iri in subjects.values() for t in self._reasoner.computed(iri)}
        self._carry_out(Step(now - there - self.withheld.keys(), there - now, set(), set()), ())

    def _carry_out(self, step: Step, retracted: Iterable[Triple]) -> None:
        lost = [*step.gone, *step.denied, *retracted]
        for triple in (*lost, *step.undenied) if self.withheld else ():
            self._admit(triple)
        try:
            self._believe(gone=step.gone, come=step.come, aside=step.denied, back=step.undenied)
        except Inconsistent:
            said = set(filter(self._is_said, step.undenied))
            self._believe(gone=step.gone, aside=step.denied, back=step.undenied - said)
            self._take_in(sorted(said.union(step.come), key=self._order))
        if self._rests:
            self._reconsider(lost)

    def _believe(
        self,
        gone: Collection[Triple] = (),
        come: Collection[Triple] = (),
        aside: Collection[Triple] = (),
        back: Collection[Triple] = (),
    ) -> None:
        """Raises Inconsistent, with everything as it was, when what comes contradicts the rest."""
        if not (gone or come or aside or back):
            return
        if len(come) <= PART:
            self._moved.update(self._reasoner.believe(gone=gone, come=come, aside=aside, back=back).others)
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
        reasoner, taken = self._reasoner, list[Triple]()
        self._moved.update(reasoner.believe(gone=gone, aside=aside, back=back).others)
        try:
            for part in parts(come, PART, self._progress):
                self._moved.update(reasoner.believe(come=part).others)
                taken += part
        except Inconsistent:
            reasoner.believe(gone=taken, come=gone, aside=back, back=aside)
            raise

    # What contradicts

    def _take_in(self, facts: Sequence[Triple]) -> None:
        """Believe all that contradicts nothing."""
        if not facts:
            return
        said = [t for t in facts if self._is_said(t)]
        try:
            self._believe(come=[t for t in facts if t not in said], back=said)
        except Inconsistent as error:
            if len(facts) > 1:
                half = len(facts) // 2
                self._take_in(facts[:half])
                self._take_in(facts[half:])
            else:
                self._refuse(facts[0], error.explanation)

    def _refuse(self, fact: Triple, found: Explanation) -> None:
        """Withhold a fact that contradicts the rest, or one that counts less and has its part in that."""
        doubtful = [t for t in found.support if self._reasoner.is_computed(t)]
        if self._is_said(fact):
            doubtful += [t for t in found.support if fact_of(t) is not None and t not in doubtful]
        last = max((*doubtful, fact), key=self._order)
        if last == fact:
            self._note(fact, found)
            return
        self._withhold(last, found)
        self._take_in([fact])
        self._reconsider([last])

    def _withhold(self, fact: Triple, found: Explanation, *, is_there: bool = True) -> None:
        """Believe a fact no longer."""
        if not is_there:
            self._reasoner.believe(aside=[fact])
        elif self._reasoner.is_computed(fact):
            self._believe(gone=[fact])
        else:
            self._believe(aside=[fact])
        self._note(fact, found)

    def _note(self, fact: Triple, found: Explanation) -> None:
        self._admit(fact)
        self.withheld[fact] = found
        if fact not in self._formerly:
            self._newly[fact] = None
        for triple in found.support:
            if triple != fact:
                self._rests.setdefault(triple, set()).add(fact)

    def _admit(self, fact: Triple) -> None:
        """A fact is no longer withheld."""
        found = self.withheld.pop(fact, None)
        if found is not None and fact not in self._newly:
            self._formerly.add(fact)
        for triple in () if found is None else found.support:
            resting = self._rests.get(triple, set())
            resting.discard(fact)
            if not resting:
                self._rests.pop(triple, None)

    def _reconsider(self, lost: Iterable[Triple]) -> None:
        """What contradicted something that is not believed any more may not do so now."""
        waiting = {fact for triple in lost for fact in self._rests.get(triple, ())}
        waiting.update(triple for triple in lost if triple in self.withheld)
        for fact in sorted(waiting, key=self._order):
            if fact in self.withheld:
                self._admit(fact)
                self._take_in([fact])

    def _is_said(self, fact: Triple) -> bool:
        """Whether a fact is asserted."""
        return any(self._reasoner.asserted(*fact))

    def _order(self, fact: Triple) -> tuple[bool, Triple]:
        """Of two that contradict each other the greater is withheld: said ones count more than computed."""
        return (not self._is_said(fact), fact)


def _declared(reasoner: Reasoner) -> frozenset[Term]:
    """The properties that are computed and that the TBox has."""
    return frozenset(p for p in COMPUTED if any(reasoner.asserted(p, v.RDF_TYPE, None)))
