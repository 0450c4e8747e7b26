"""The engine for OWL 2 DL: a compiled schema, and an ABox whose closure is maintained incrementally."""

from __future__ import annotations

import hashlib
from collections.abc import Collection, Container, Iterable, Iterator, Sequence, Set
from itertools import chain

from semmap.nodes.kb_node.reasoner.abox.abox import ABox
from semmap.nodes.kb_node.reasoner.abox.abox_view import View
from semmap.nodes.kb_node.reasoner.abox.columns import Columns
from semmap.nodes.kb_node.reasoner.abox.kinds import Kind
from semmap.nodes.kb_node.reasoner.abox.retraction import Retraction
from semmap.nodes.kb_node.reasoner.abox.saturation import Saturation
from semmap.nodes.kb_node.reasoner.abox.snapshot import columns_of, fill
from semmap.nodes.kb_node.reasoner.abox.store import COMPUTED
from semmap.nodes.kb_node.reasoner.change import Change
from semmap.nodes.kb_node.reasoner.explain.proof import Prover
from semmap.nodes.kb_node.reasoner.explain.reasons import Clash
from semmap.nodes.kb_node.reasoner.explain.schema_support import SchemaSupport
from semmap.nodes.kb_node.reasoner.explain.support import Support
from semmap.nodes.kb_node.reasoner.explain.words import Words
from semmap.nodes.kb_node.reasoner.explanations import Explanation, Term, Triple
from semmap.nodes.kb_node.reasoner.fastpaths.entity_order import order_by_entity
from semmap.nodes.kb_node.reasoner.fastpaths.paths import FastPaths, KnownContradiction, NoFastPaths
from semmap.nodes.kb_node.reasoner.fastpaths.shapes import UniformRuns
from semmap.nodes.kb_node.reasoner.rules import swrl
from semmap.nodes.kb_node.reasoner.rules.closure import Closure
from semmap.nodes.kb_node.reasoner.rules.facts import Facts
from semmap.nodes.kb_node.reasoner.rules.time_limit import TimeLimit
from semmap.nodes.kb_node.reasoner.tbox.axioms import DIFFERENT, NotCompilable
from semmap.nodes.kb_node.reasoner.tbox.schema import Schema
from semmap.nodes.kb_node.reasoner.tbox.split import (
    check_all_compilable,
    check_compilable,
    is_inert,
    is_schema,
)
from semmap.nodes.kb_node.reasoner.terms import DIFFERENT_FROM, SAME_AS, TYPE, iri, is_named


class Refused(Exception):
    """A change was undone because it contradicts the other facts."""

    def __init__(self, explanation: Explanation) -> None:
        super().__init__(explanation.text)
        self.explanation = explanation


class CompiledEngine:
    """A compiled schema and an ABox.

    Raises:
        NotCompilable: this engine does not support the graph; `general.GeneralEngine` does.
        Refused: the triples contradict each other.
    """

    def __init__(
        self,
        triples: Iterable[Triple],
        closed: Facts | None = None,
        *,
        scattered: bool = False,
        fast: bool = True,
    ) -> None:
        """Load triples. `closed` is the closure of their schema, if it is known.

        `scattered` triples are first sorted by individual. Without `fast`, the rules are applied to every
        change, even if its consequences are known from a similar one.
        """
        triples = list(triples)
        self._prover = Prover(Words.of(triples))
        self._schema_triples = dict.fromkeys(filter(is_schema, triples))
        self._inert = Facts(dict.fromkeys(filter(is_inert, self._schema_triples)))
        active = dict.fromkeys(t for t in self._schema_triples if t not in self._inert.facts)
        check_all_compilable(active)
        closure = closed or Closure(active)
        if closure.clash is not None:
            raise Refused(self._prover.prove(closure.leaves(None), None))
        equal = [t for t in closure.match(None, SAME_AS) if t[0] != t[2] and is_named(t[2])]
        below = closure.match(None, iri("rdfs:subPropertyOf"), SAME_AS)
        if equal and any(p != SAME_AS for p, _, _ in below):  # the axioms would mention either of the two
            raise NotCompilable(f"the schema alone equates individuals: {' '.join(min(equal))}")
        self.rules = swrl.read_triples(self._schema_triples)
        """The SWRL rules of the schema."""
        self._schema = Schema(closure, self.rules.supported)
        schema_facts = (*closure.facts, *self._inert.facts)
        self._schema_subjects = frozenset(s for s, _, _ in schema_facts)
        self._schema_objects = frozenset(o for _, _, o in schema_facts)
        self._abox = ABox(self._schema)
        self._saturation = Saturation(self._abox)
        self._paths = FastPaths(self._abox) if fast else NoFastPaths()
        self._view = View(self._abox)
        self._schema_support = SchemaSupport(self._schema)
        self._size = len(self._schema_triples)
        try:
            self._saturation.apply_rules()
            self._saturation.run()
        except Clash as clash:
            found = Support(self._abox, self._schema_support).of_clash(clash.claims)
            raise Refused(self._prover.prove(found, None)) from None
        self._abox.settle()
        data = [triple for triple in triples if triple not in self._schema_triples]
        self.apply((), order_by_entity(data) if scattered else data)

    def __len__(self) -> int:
        return self._size

    @property
    def words(self) -> Words:
        """The words for terms in sentences."""
        return self._prover.words

    @property
    def axioms(self) -> Collection[Triple]:
        """The asserted triples of the schema."""
        return self._schema_triples

    @property
    def closed(self) -> Facts:
        """The closure of the schema."""
        return self._schema.closure

    def apply(self, delete: Sequence[Triple], insert: Sequence[Triple]) -> Change:
        """Delete and insert triples.

        Raises:
            Refused: the change contradicts the other facts; nothing was changed.
            NotCompilable: this engine does not support the change; nothing was changed.
        """
        abox = self._abox
        if delete:
            changed = self._paths.apply_independent(delete, insert)
            if changed is not None:
                self._size += len(insert) - len(delete)
                return Change(frozenset(changed))
            if any(map(is_schema, delete)):
                raise NotCompilable("the schema changes")
        added: list[Triple] = []
        removed: list[Triple] = []
        touched: set[Term] = set()
        alike: list[UniformRuns] = []
        retraction = Retraction(abox, self._saturation) if delete else None
        try:
            if retraction is None:
                alike = self._paths.insert(insert, lambda some: self._insert(some, added, touched), added)
            else:
                removed = self._paths.remove_individuals(delete)
                left = set(delete).difference(removed) if removed else delete
                removed += retraction.delete(tuple(left))[0]
                touched.update([s for s, _, _ in removed])
                self._insert(insert, added, touched)
        except KnownContradiction as known:
            raise Refused(known.explanation) from None
        except Clash as clash:
            proof, terms = self._prover.proof(
                Support(abox, self._schema_support).of_clash(clash.claims), None
            )
            self._undo(retraction, removed, added)
            if not removed:
                self._paths.note_rejection(insert, proof, terms)
            raise Refused(proof.about(terms)) from None
        except NotCompilable:
            self._undo(retraction, removed, added)
            raise
        if abox.changed_kinds or abox.overlaid or abox.regrouped:
            touched.update(self._reclassified())
            touched.update(abox.store.terms[node] for node in abox.regrouped)
            abox.settle()
        if retraction is not None:
            retraction.release()
        self._size += len(added) - len(removed)
        return Change(frozenset(touched), alike)

    def update_computed(
        self,
        remove: Sequence[Triple],
        add: Sequence[Triple],
        suppress: Sequence[Triple],
        restore: Sequence[Triple],
        *,
        report_implied: bool,
    ) -> Change:
        """Remove and add computed facts; suppress asserted facts, or restore suppressed ones.

        `Change.others` has the individuals whose named classes changed, `Change.implied` is set with
        `report_implied`. Raises the same errors as `apply`.
        """
        abox, insert = self._abox, self._saturation.insert
        added: list[Triple] = []
        removed: tuple[list[Triple], list[Triple]] = [], []
        computed: list[Triple] = []
        retraction = Retraction(abox, self._saturation) if remove or suppress else None
        log = list[tuple[int, int, int]]()
        if report_implied:
            abox.store.log = log
        try:
            if retraction is not None:
                removed = retraction.delete(suppress, remove)
            for triple in restore:
                if insert(triple):
                    added.append(triple)
            self._paths.compute(add, insert, computed)
            self._saturation.run()
        except (Clash, NotCompilable) as error:
            explanation = None
            if isinstance(error, Clash):
                found = Support(abox, self._schema_support).of_clash(error.claims)
                explanation = self._prover.prove(found, None)
            self._undo(retraction, removed[0], added, removed[1], computed)
            if explanation is None:
                raise
            raise Refused(explanation) from None
        finally:
            abox.store.log = None
        touched = frozenset(self._reclassified()) if abox.changed_kinds else frozenset[Term]()
        if abox.regrouped:
            touched |= {abox.store.terms[node] for node in abox.regrouped}
        implied = self._implied(log) if report_implied else None
        abox.settle()
        if retraction is not None:
            retraction.release()
        self._size += len(added) - len(removed[0])
        return Change(touched, implied=implied)

    def _implied(self, edges: Iterable[tuple[int, int, int]]) -> frozenset[Triple] | None:
        """Return what each edge implies alone; None if edges may imply more in combination with others."""
        abox, schema, terms = self._abox, self._schema, self._abox.store.terms
        if abox.equals or any(map(self._matches_rules, abox.changed_kinds.items())):
            return None
        found: set[Triple] = set()
        for s, p, o in set(edges):
            rules = abox.steps.rules(p)
            if p <= DIFFERENT or abox.is_literal(o) or (rules is not None and rules.implies_more):
                return None
            for q, backwards in schema.roles(p):
                if q in schema.virtual:
                    return None
                x, y = (o, s) if backwards else (s, o)
                if schema.axioms[q].is_shown:
                    found.add((terms[x], schema.axioms[q].term, terms[y]))
        return frozenset(found)

    def _matches_rules(self, change: tuple[int, Kind]) -> bool:
        """Return whether a SWRL rule may match a node with its present or its previous kind only."""
        node, before = change
        return bool((self._abox.store.kind[node].mask ^ before.mask) & self._schema.rule_classes)

    def _insert(self, triples: Sequence[Triple], added: list[Triple], touched: set[Term]) -> None:
        """Insert triples and draw all conclusions. New triples are appended to `added`."""
        types = [triple for triple in triples if triple[1] == TYPE]
        edges = [triple for triple in triples if triple[1] != TYPE]
        for batch in (types, edges):  # a node that has its kind before its edges is processed only once
            for triple in batch:
                if is_schema(triple):
                    raise NotCompilable("the schema changes")
                if triple[1] in (SAME_AS, DIFFERENT_FROM):
                    self._check(triple)
                if self._saturation.insert(triple):
                    added.append(triple)
                    touched.add(triple[0])
            self._saturation.run()

    def _check(self, triple: Triple) -> None:
        check_compilable(triple)
        if self._schema.is_used(triple[0]) or self._schema.is_used(triple[2]):
            raise NotCompilable(f"classes or properties are compared: {' '.join(triple)}")

    def _undo(
        self,
        retraction: Retraction | None,
        removed: list[Triple],
        added: list[Triple],
        removed_computed: Sequence[Triple] = (),
        added_computed: Sequence[Triple] = (),
    ) -> None:
        """Revert a change that failed."""
        undo = Retraction(self._abox, self._saturation)
        overlaid = tuple(self._abox.overlaid)
        undo.delete(added, added_computed)
        for triple in removed:
            self._saturation.insert(triple)
        for triple in (*removed_computed, *overlaid):
            self._saturation.insert(triple, COMPUTED)
        self._saturation.run()
        self._abox.settle()
        undo.release()
        if retraction is not None:
            retraction.release()

    def _reclassified(self) -> Iterator[Term]:
        """Yield the individuals whose named classes changed."""
        store = self._abox.store
        for node, before in self._abox.changed_kinds.items():
            if before.excluded is None and store.kind[node].names != before.names:
                yield store.terms[node]

    def equals(self, individual: Term) -> Collection[Term]:
        """Return the individuals that are the same as one, itself included; none if it is only itself."""
        abox = self._abox
        node = abox.store.find(individual) if abox.equals else None
        found = None if node is None else abox.equals.get(node)
        return () if found is None else [abox.store.terms[member] for member in found.members]

    def matches(self, rule: swrl.SwrlRule, limit: TimeLimit) -> Iterator[tuple[int | Term, ...]]:
        """Yield the matches of a SWRL rule, in which equal individuals are one. Raises OutOfTime."""
        return self._saturation.matches(rule, limit)

    def asserted(self, s: Term | None, p: Term | None, o: Term | None) -> Iterator[Triple]:
        """Return the asserted triples that match a pattern."""
        found = self._view.asserted(s, p, o)
        is_data_only = o not in self._schema_objects if s is None else s not in self._schema_subjects
        if is_data_only and (s, o) != (None, None):  # the common case
            return found
        return chain(found, self._asserted_schema(s, p, o))

    def _asserted_schema(self, s: Term | None, p: Term | None, o: Term | None) -> Iterator[Triple]:
        for facts in (self._schema.closure, self._inert):
            for triple in facts.match(s, p, o):
                if triple in self._schema_triples:
                    yield triple

    def computed(self, s: Term | None, p: Term | None, o: Term | None) -> Iterator[Triple]:
        """Return the computed triples that match a pattern."""
        return self._view.computed(s, p, o)

    def is_computed(self, triple: Triple) -> bool:
        """Return whether a triple is computed and not asserted."""
        return self._view.is_computed(triple)

    def without_unchanged_axioms(
        self, delete: Sequence[Triple], insert: Sequence[Triple]
    ) -> tuple[list[Triple], list[Triple]]:
        """Return a change without the axioms that it does not change."""
        present, inserted = self._schema_triples, set(insert)
        deleted = [t for t in delete if not is_schema(t) or (t in present and t not in inserted)]
        return deleted, [t for t in insert if not is_schema(t) or t not in present]

    def columns(self, schema: Container[Triple] | None) -> Columns | None:
        """Return the ABox as columns, for `fill`.

        Returns None if there are axioms outside `schema`, or if columns cannot represent the ABox.
        """
        if schema is not None and not all(triple in schema for triple in self._schema_triples):
            return None
        return columns_of(self._abox, schema=self._digest(), size=self._size)

    def fill(self, columns: Columns) -> bool:
        """Load columns. Returns False and changes nothing if their schema differs."""
        if columns.schema != self._digest() or not fill(self._abox, columns):
            return False
        self._size = columns.size
        return True

    def _digest(self) -> bytes:
        """Return a digest of the schema's triples."""
        lines = sorted(map(" ".join, self._schema_triples))
        return hashlib.blake2b("\n".join(lines).encode(), digest_size=16).digest()

    def by_subject(self) -> Iterator[list[Triple]]:
        """Return the asserted triples in groups. The ABox may change between two groups."""
        yield list(self._schema_triples)
        yield from self._view.by_subject()

    def about(self, subject: Term) -> dict[Term, list[Term]]:
        """Return the asserted triples of a subject: predicate to objects."""
        objects = self._view.about(subject)
        if subject not in self._schema_subjects:
            return objects
        for _, predicate, object_ in self._asserted_schema(subject, None, None):
            objects.setdefault(predicate, []).append(object_)
        return objects

    def mentioned(self, terms: Set[Term]) -> set[Term]:
        """Return those of `terms` that are the subject or object of a triple."""
        return (self._abox.store.numbers.keys() & terms) | (self._schema_subjects & terms)

    def inferred(self, s: Term | None, p: Term | None, o: Term | None) -> Iterator[Triple]:
        """Return the inferred triples of a pattern that are not asserted.

        Inferred axioms are returned only if the pattern has their predicate.
        """
        yield from self._view.inferred(s, p, o)
        if p is not None and (p != TYPE or (o is not None and is_schema((o, p, o)))):
            for triple in self._schema.closure.match(s, p, o):
                if triple not in self._schema_triples and is_schema(triple):
                    yield triple

    def holds(self, triple: Triple) -> bool:
        """Return whether a triple is asserted or inferred."""
        return self._view.holds(triple) or self._schema.closure.holds(triple) or triple in self._inert.facts

    def types(self, individual: Term) -> frozenset[Term]:
        """Return the named classes of an individual."""
        return self._view.types(individual)

    def instances(self, cls: Term) -> Iterator[Term]:
        """Return the individuals of a class."""
        return self._view.instances(cls)

    def explain(self, triple: Triple) -> Explanation:
        """Return the proof of a triple that holds."""
        closure = self._schema.closure
        if triple in closure.facts:
            return self._prover.prove(closure.leaves(triple), triple)
        if (
            next(self._view.asserted(*triple), None)
            or self._view.is_computed(triple)
            or triple in self._inert.facts
        ):
            return self._prover.prove([triple], triple)
        s, p, o = triple
        if not self._view.holds(triple) or (p == SAME_AS and s == o):
            return self._prover.prove((), triple)  # an axiomatic triple, or eq-ref
        return self._prover.prove(Support(self._abox, self._schema_support).of_triple(triple), triple)
