"""The interface of the reasoner."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Container, Iterable, Iterator, Sequence, Set
from contextlib import contextmanager
from itertools import chain, groupby
from math import inf
from typing import NamedTuple

from semmap.nodes.kb_node.reasoner.abox.columns import Columns
from semmap.nodes.kb_node.reasoner.change import Change
from semmap.nodes.kb_node.reasoner.compiled import CompiledEngine, Refused
from semmap.nodes.kb_node.reasoner.explain.axiom_sentences import AxiomVerbalizer
from semmap.nodes.kb_node.reasoner.explain.words import Words
from semmap.nodes.kb_node.reasoner.explanations import Explanation, Term, Triple
from semmap.nodes.kb_node.reasoner.rules.facts import Facts
from semmap.nodes.kb_node.reasoner.rules.general import GeneralEngine
from semmap.nodes.kb_node.reasoner.rules.swrl import SwrlRule
from semmap.nodes.kb_node.reasoner.rules.time_limit import OutOfTime, TimeLimit
from semmap.nodes.kb_node.reasoner.suppressed import SuppressedFacts
from semmap.nodes.kb_node.reasoner.tbox.axioms import NotCompilable
from semmap.nodes.kb_node.reasoner.tbox.profile import outside_rl
from semmap.nodes.kb_node.reasoner.tbox.split import is_schema
from semmap.nodes.kb_node.reasoner.terms import iri, is_literal, is_named

_SUB_CLASS_OF = iri("rdfs:subClassOf")


class Inconsistent(Exception):
    """A change was undone because it contradicts the other facts. `explanation` has the proof."""

    def __init__(self, explanation: Explanation) -> None:
        super().__init__(explanation.text)
        self.explanation = explanation


class RuleUse(NamedTuple):
    """A SWRL rule of the schema."""

    node: Term
    text: str
    """The rule as a sentence; empty if it is not supported."""
    holds: int | None
    """How often the rule holds now; None if it is not supported."""
    unsupported: str
    """The reason why the rule has no effect, or ""."""
    is_cut: bool = False
    """Whether counting reached the time limit, so that the rule may hold more often."""


class GivenFacts(NamedTuple):
    """The facts that hold without inference: asserted and not suppressed, or computed."""

    asserted: list[Triple]
    computed: list[Triple]


class Reasoner:
    """A consistent TBox and ABox, with all conclusions of the OWL 2 RL/RDF rules.

    Terms are strings in N-Triples syntax. None in a pattern is a wildcard. Not thread-safe.
    """

    def __init__(
        self,
        tbox: Iterable[Triple] = (),
        *,
        closed: Facts | None = None,
        scattered: bool = False,
        fast: bool = True,
    ) -> None:
        """Load triples. Raises Inconsistent if they contradict each other.

        `closed` is the property `closed` of another reasoner with the same schema. The other two options only
        affect speed: set `scattered` for triples that are not grouped by individual. Without `fast`, the
        rules are applied to every change, even if its consequences are known from a similar one.
        """
        self._fast = fast
        self._closures: dict[frozenset[Triple], Facts] = {}
        """Known closures of schemas, by their axioms."""
        self._engine: CompiledEngine | GeneralEngine = _engine_for(tbox, closed, scattered, fast)
        self._suppressed = SuppressedFacts()

    def __len__(self) -> int:
        """Return the number of asserted triples, including the TBox."""
        return len(self._engine) + len(self._suppressed)

    @property
    def is_compiled(self) -> bool:
        """Whether changes are processed incrementally. Otherwise each change recomputes everything."""
        return isinstance(self._engine, CompiledEngine)

    @property
    def words(self) -> Words:
        """The words for terms in sentences: labels of the TBox, or local names."""
        return self._engine.words

    @property
    def not_incremental(self) -> str | None:
        """The reason why changes are not processed incrementally; None if they are.

        Every valid OWL 2 RL ontology is processed incrementally. Exceptions are OWL Full graphs: classes or
        properties are the same as others, an individual equals a value, or the OWL vocabulary is redefined.
        """
        return self._engine.reason if isinstance(self._engine, GeneralEngine) else None

    @property
    def outside_rl(self) -> Counter[str]:
        """The number of axioms beyond OWL 2 RL, by kind. The rules miss some of their consequences."""
        return outside_rl(filter(is_schema, self.asserted()))

    @property
    def closed(self) -> Facts | None:
        """The closure of the schema; None if the schema is not processed separately."""
        return self._engine.closed if isinstance(self._engine, CompiledEngine) else None

    @property
    def axioms(self) -> frozenset[Triple]:
        """The asserted triples of the schema."""
        if isinstance(self._engine, CompiledEngine):
            return frozenset(self._engine.axioms)
        return frozenset(filter(is_schema, self.asserted()))

    @contextmanager
    def knowing(self, axioms: frozenset[Triple], closed: Facts) -> Iterator[None]:
        """Use `closed` as the closure of the schema whenever it has exactly these axioms, in this context.

        Computing a closure takes most of the time of a change of the schema. That of the schema before is
        kept meanwhile, for a rollback.
        """
        self._closures[axioms] = closed
        try:
            yield
        finally:
            self._closures.clear()

    def columns(self, schema: Container[Triple] | None = None) -> Columns | None:
        """Return the ABox with its conclusions as columns; None if columns cannot represent it.

        They cannot if the map itself declares classes, that is, if there are axioms outside `schema`.
        """
        return self._engine.columns(schema) if isinstance(self._engine, CompiledEngine) else None

    def fill(self, columns: Columns) -> bool:
        """Load the columns of another reasoner with the same schema. Only the TBox may be loaded before.

        Returns False and changes nothing if the schema differs. Apply the triples of the columns instead.
        """
        return isinstance(self._engine, CompiledEngine) and self._engine.fill(columns)

    def apply(self, *, delete: Iterable[Triple] = (), insert: Iterable[Triple] = ()) -> Change:
        """Apply one transaction: delete, then insert, then check consistency.

        Deleting an absent triple or inserting a present one changes nothing. Triples of the schema are
        allowed, but then the whole map is loaded again.

        Raises:
            Inconsistent: the change contradicts the other facts; nothing was changed.
        """
        delete, insert = list(delete), list(insert)
        if not self._suppressed:
            return self._apply(delete, insert)
        dropped = [triple for triple in delete if triple in self._suppressed]
        change = self._apply(
            [triple for triple in delete if triple not in self._suppressed],
            [triple for triple in insert if triple not in self._suppressed or triple in dropped],
        )
        self._suppressed.remove(dropped)
        return Change(change.others | {s for s, _, _ in dropped}, change.alike)

    def _apply(self, delete: list[Triple], insert: list[Triple]) -> Change:
        engine = self._engine
        if isinstance(engine, CompiledEngine):
            try:
                return engine.apply(delete, insert)
            except Refused as refused:
                raise Inconsistent(refused.explanation) from None
            except NotCompilable:  # the engine has undone the change
                old, new = engine.without_unchanged_axioms(delete, insert)
                if len(old) + len(new) < len(delete) + len(insert):
                    return self._apply(old, new)
        return self._rebuild(delete, insert, (), ())

    def update_computed(
        self,
        *,
        remove: Iterable[Triple] = (),
        add: Iterable[Triple] = (),
        suppress: Iterable[Triple] = (),
        restore: Iterable[Triple] = (),
        report_implied: bool = False,
    ) -> Change:
        """Remove and add computed facts; suppress asserted facts, or restore suppressed ones.

        A computed fact holds without being asserted. A suppressed fact is asserted but does not hold.
        Removing an absent fact or adding a present one changes nothing.

        Returns the individuals whose named classes or equals changed, and with `report_implied` also
        `Change.implied`.

        Raises:
            Inconsistent: the change contradicts the other facts; nothing was changed.
        """
        remove, add, suppress = list(remove), list(add), list(suppress)
        restore = [triple for triple in restore if triple in self._suppressed]
        engine = self._engine
        try:
            if isinstance(engine, CompiledEngine):
                change = engine.update_computed(remove, add, suppress, restore, report_implied=report_implied)
            else:
                change = self._rebuild(suppress, restore, remove, add)
        except Refused as refused:
            raise Inconsistent(refused.explanation) from None
        except NotCompilable:
            change = self._rebuild(suppress, restore, remove, add)
        self._suppressed.remove(restore)
        self._suppressed.add(suppress)
        return change

    def _rebuild(
        self,
        delete: Sequence[Triple],
        insert: Sequence[Triple],
        remove: Iterable[Triple],
        add: Iterable[Triple],
    ) -> Change:
        """Apply a change by loading all triples into a new engine."""
        before = dict.fromkeys(self._engine.asserted(None, None, None))
        after = before.copy()
        for triple in delete:
            after.pop(triple, None)
        after.update(dict.fromkeys(insert))
        computed = dict.fromkeys(self.computed())
        for triple in remove:
            computed.pop(triple, None)
        computed.update(dict.fromkeys(add))
        known = self._closures if self.closed is None else {**self._closures, self.axioms: self.closed}
        closed = known.get(frozenset(filter(is_schema, after)))
        engine = _engine_for(after, closed, scattered=True, fast=self._fast, computed=computed)
        old, self._engine = self._engine, engine
        if self._closures:
            self._closures = known
        individuals = {s for s, _, _ in (*before, *after)} | {o for _, _, o in (*before, *after)}
        touched = {s for s, _, _ in before.keys() ^ after.keys()}
        touched |= {term for term in individuals if old.types(term) != engine.types(term)}
        touched |= {term for term in individuals if set(old.equals(term)) != set(engine.equals(term))}
        return Change(frozenset(term for term in touched if not is_literal(term)))

    @contextmanager
    def assuming(self, triples: Iterable[Triple], *, allow_recompute: bool = True) -> Iterator[None]:
        """Add triples for the duration of a `with` block, then restore the previous state.

        Without `allow_recompute`, only changes that the compiled engine can apply and revert are tried.

        Raises:
            Inconsistent: the assumptions contradict the other facts.
            NotCompilable: everything would have to be recomputed, which `allow_recompute` forbids.
        """
        new = [
            triple
            for triple in dict.fromkeys(triples)
            if next(self.asserted(*triple), None) is None and not self.is_computed(triple)
        ]
        engine = self._engine
        if isinstance(engine, CompiledEngine):
            try:
                engine.apply((), new)
            except Refused as refused:
                raise Inconsistent(refused.explanation) from None
            except NotCompilable:
                if not allow_recompute:
                    raise
            else:
                try:
                    yield
                finally:
                    engine.apply(new, ())
                return
        elif not allow_recompute:
            raise NotCompilable("the general engine recomputes everything for each change")
        asserted = engine.asserted(None, None, None)
        self._engine = _engine_for([*asserted, *new], fast=self._fast, computed=list(self.computed()))
        try:
            yield
        finally:
            self._engine = engine

    def asserted(
        self, s: Term | None = None, p: Term | None = None, o: Term | None = None
    ) -> Iterator[Triple]:
        """Return the asserted triples that match a pattern, including suppressed ones."""
        found = self._engine.asserted(s, p, o)
        return chain(found, self._suppressed.match(s, p, o)) if self._suppressed else found

    def computed(
        self, s: Term | None = None, p: Term | None = None, o: Term | None = None
    ) -> Iterator[Triple]:
        """Return the computed triples that match a pattern and are not also asserted."""
        return self._engine.computed(s, p, o)

    def given(self, s: Term | None = None, p: Term | None = None, o: Term | None = None) -> Iterator[Triple]:
        """Return the facts of a pattern that are asserted and not suppressed, or computed."""
        return chain(self._engine.asserted(s, p, o), self._engine.computed(s, p, o))

    def is_computed(self, triple: Triple) -> bool:
        """Return whether a triple is computed and not asserted."""
        return self._engine.is_computed(triple)

    def suppressed(self) -> Iterator[Triple]:
        """Return the suppressed facts: asserted, but not holding."""
        return iter(self._suppressed)

    @property
    def has_suppressed(self) -> bool:
        """Whether any fact is suppressed."""
        return bool(self._suppressed)

    def suppressed_about(self, terms: Iterable[Term]) -> set[Triple]:
        """Return the suppressed facts whose subject or object is one of `terms`."""
        return self._suppressed.about(terms)

    def given_facts(self) -> GivenFacts:
        """Return all `given` facts, to create a copy with `Reasoner.of`."""
        return GivenFacts(list(self._engine.asserted(None, None, None)), list(self.computed()))

    @classmethod
    def of(cls, facts: GivenFacts) -> Reasoner:
        """Create a reasoner in which the same facts hold, without suppressed facts. Raises Inconsistent."""
        reasoner = cls(facts.asserted)
        reasoner.update_computed(add=facts.computed)
        return reasoner

    def by_subject(self) -> Iterator[list[Triple]]:
        """Return the asserted triples grouped by subject, for callers that read them in several steps.

        The triples may change between two groups. A triple that is asserted during the whole iteration is
        returned, one that is never asserted is not.
        """
        engine = self._engine
        if not isinstance(engine, CompiledEngine):
            return iter([list(self.asserted())])
        return chain(engine.by_subject(), map(list, (self._suppressed,)))

    def about(self, subject: Term) -> dict[Term, list[Term]]:
        """Return the asserted triples of a subject as a mapping from predicate to objects.

        The time is proportional to the number of these triples.
        """
        found = self._engine.about(subject)
        if self._suppressed:
            for _, predicate, object_ in self._suppressed.match(subject, None, None):
                found.setdefault(predicate, []).append(object_)
        return found

    def mentioned(self, terms: Set[Term]) -> set[Term]:
        """Return those of `terms` that may be the subject or object of a triple. All others are new."""
        return self._engine.mentioned(terms) | self._suppressed.mentioned(terms)

    def inferred(
        self, s: Term | None = None, p: Term | None = None, o: Term | None = None
    ) -> Iterator[Triple]:
        """Return the triples of a pattern about individuals that are computed or inferred, but not asserted.

        Anonymous classes and `x owl:sameAs x` are left out; `holds` answers both. A value is returned once,
        in its canonical spelling (`datatypes.canonical`), unless it was asserted in any spelling. Inferred
        axioms are returned only if the predicate of the pattern asks for them.
        """
        return self._engine.inferred(s, p, o)

    def holds(self, triple: Triple) -> bool:
        """Return whether a triple is asserted, computed or inferred. Suppressed facts do not hold."""
        return self._engine.holds(triple)

    def follows(self, triple: Triple) -> bool:
        """Return whether a triple is computed or inferred, and not asserted (or asserted but suppressed)."""
        return self._engine.holds(triple) and next(self._engine.asserted(*triple), None) is None

    def types(self, individual: Term) -> frozenset[Term]:
        """Return the named classes of an individual, asserted and inferred."""
        return self._engine.types(individual)

    def instances(self, cls: Term) -> Iterator[Term]:
        """Return the individuals of a class, asserted and inferred."""
        return self._engine.instances(cls)

    def equals(self, individual: Term) -> Collection[Term]:
        """Return the individuals that are the same as one, itself included; none if it is only itself."""
        return self._engine.equals(individual)

    def superclasses(self, cls: Term) -> frozenset[Term]:
        """Return the named superclasses of a class, including the class itself."""
        wider = {o for source in (self.asserted, self.inferred) for _, _, o in source(cls, _SUB_CLASS_OF)}
        return frozenset(filter(is_named, wider)) | {cls}

    def subclasses(self, cls: Term) -> frozenset[Term]:
        """Return the named subclasses of a class, including the class itself."""
        narrower = {
            s for source in (self.asserted, self.inferred) for s, _, _ in source(None, _SUB_CLASS_OF, cls)
        }
        return frozenset(filter(is_named, narrower)) | {cls}

    def rules(self, patience_s: float = inf) -> list[RuleUse]:
        """Return the SWRL rules of the schema, and how often each holds now.

        Counting stops when all rules together have taken `patience_s` of CPU time.
        """
        limit = TimeLimit(patience_s)
        found, axioms = self._engine.rules, None
        uses: list[RuleUse] = []
        for node, rules in groupby(found.supported, key=lambda rule: rule.node):
            same = list(rules)
            axioms = axioms or AxiomVerbalizer([*filter(is_schema, self.asserted())], self.words)
            count, is_cut = self._count_matches(same[0], limit)
            uses.append(RuleUse(node, axioms.rule_sentence(same), count, "", is_cut))
        return uses + [RuleUse(node, "", None, reason) for node, reason in found.unsupported.items()]

    def _count_matches(self, rule: SwrlRule, limit: TimeLimit) -> tuple[int, bool]:
        """Return the number of matches of a rule that were found in time, and whether there may be more."""
        found: set[tuple[int | Term, ...]] = set()
        try:
            for match in self._engine.matches(rule, limit):
                found.add(match)
        except OutOfTime:
            return len(found), True
        return len(found), False

    def explain(self, triple: Triple) -> Explanation | None:
        """Return the proof of a triple; None if it does not hold."""
        return self._engine.explain(triple) if self.holds(triple) else None


def _engine_for(
    triples: Iterable[Triple],
    closed: Facts | None = None,
    scattered: bool = False,
    fast: bool = True,
    computed: Iterable[Triple] = (),
) -> CompiledEngine | GeneralEngine:
    """Return the compiled engine, or the general one if the triples need it. Raises Inconsistent."""
    triples, computed = list(dict.fromkeys(triples)), list(computed)
    try:
        compiled = CompiledEngine(triples, closed, scattered=scattered, fast=fast)
        if computed:
            compiled.update_computed((), computed, (), (), report_implied=False)
        return compiled
    except Refused as refused:
        raise Inconsistent(refused.explanation) from None
    except NotCompilable as reason:
        engine = GeneralEngine(triples, str(reason), computed)
    contradiction = engine.contradiction()
    if contradiction is not None:
        raise Inconsistent(contradiction)
    return engine
