"""The reasoner as the rest of the knowledge base sees it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Container, Iterable, Iterator, Sequence, Set
from contextlib import contextmanager
from itertools import chain
from typing import NamedTuple

from semmap.nodes.kb_node.reasoner.abox.columns import Columns
from semmap.nodes.kb_node.reasoner.aside import Aside
from semmap.nodes.kb_node.reasoner.change import Change
from semmap.nodes.kb_node.reasoner.compiled import CompiledEngine, Refused
from semmap.nodes.kb_node.reasoner.explain.words import Words
from semmap.nodes.kb_node.reasoner.explanations import Explanation, Term, Triple
from semmap.nodes.kb_node.reasoner.rules.facts import Facts
from semmap.nodes.kb_node.reasoner.rules.general import GeneralEngine
from semmap.nodes.kb_node.reasoner.tbox.axioms import NotCompilable
from semmap.nodes.kb_node.reasoner.tbox.profile import outside_rl
from semmap.nodes.kb_node.reasoner.tbox.split import is_schema
from semmap.nodes.kb_node.reasoner.terms import iri, is_literal, is_named

_SUB_CLASS_OF = iri("rdfs:subClassOf")


class Inconsistent(Exception):
    """A change that contradicts the rest; it was undone. `explanation` says why."""

    def __init__(self, explanation: Explanation) -> None:
        super().__init__(explanation.text)
        self.explanation = explanation


class Held(NamedTuple):
    """What holds by itself: what is asserted and not set aside, and what is computed."""

    asserted: list[Triple]
    computed: list[Triple]


class Reasoner:
    """A TBox and an ABox that are consistent, and what follows from them by the OWL 2 RL/RDF rules.

    Terms are strings in N-Triples syntax. A pattern's None is a wildcard. Not thread-safe.
    """

    def __init__(
        self,
        tbox: Iterable[Triple] = (),
        *,
        closed: Facts | None = None,
        scattered: bool = False,
        fast: bool = True,
    ) -> None:
        """Start with some triples. Raises Inconsistent when they contradict each other.

        `closed` is what another reasoner's `closed` was that had the same schema. Triples that do not come
        individual by individual, but as a store gives them, are `scattered`: that is only about speed. So is
        `fast`: without it, changes like earlier ones are worked out like any other.
        """
        self._fast = fast
        self._engine: CompiledEngine | GeneralEngine = _engine_for(tbox, closed, scattered, fast)
        self._aside = Aside()

    def __len__(self) -> int:
        """How many triples are asserted, the TBox's included."""
        return len(self._engine) + len(self._aside)

    @property
    def is_compiled(self) -> bool:
        """Whether changes are worked out one by one; else everything is, at each change."""
        return isinstance(self._engine, CompiledEngine)

    @property
    def words(self) -> Words:
        """What terms are called in sentences: labels of the TBox, or names."""
        return self._engine.words

    @property
    def not_incremental(self) -> str | None:
        """What keeps changes from being worked out one by one; None when nothing does.

        No valid ontology of OWL 2 RL does. It takes a graph of OWL Full: one in which classes or properties
        are the same as others, an individual is a value, or the vocabulary itself gets another meaning.
        """
        return self._engine.why if isinstance(self._engine, GeneralEngine) else None

    @property
    def outside_rl(self) -> Counter[str]:
        """How many axioms of each kind say more than OWL 2 RL can, so that the rules miss some of it."""
        return outside_rl(filter(is_schema, self.asserted()))

    @property
    def closed(self) -> Facts | None:
        """All that follows from the schema, if that is worked out by itself."""
        return self._engine.closed if isinstance(self._engine, CompiledEngine) else None

    def columns(self, schema: Container[Triple] | None = None) -> Columns | None:
        """What is held beyond the schema, conclusions included; None where columns cannot say it.

        They cannot if more counts as schema than the `schema` that they are to be filled in with: a map may
        declare classes, too.
        """
        return self._engine.columns(schema) if isinstance(self._engine, CompiledEngine) else None

    def fill(self, columns: Columns) -> bool:
        """Hold what another reasoner of the same schema held; nothing but the TBox is held yet.

        False, with nothing done, if the schema was another: then apply the columns' triples.
        """
        return isinstance(self._engine, CompiledEngine) and self._engine.fill(columns)

    def apply(self, *, delete: Iterable[Triple] = (), insert: Iterable[Triple] = ()) -> Change:
        """One transaction: deletes, then inserts, then checks.

        Deleting what is not there and inserting what is there changes nothing. Triples of the schema are
        allowed and cost as much as loading the whole map anew.

        Raises:
            Inconsistent: everything is as it was before.
        """
        delete, insert = list(delete), list(insert)
        if not self._aside:
            return self._apply(delete, insert)
        dropped = [triple for triple in delete if triple in self._aside]
        change = self._apply(
            [triple for triple in delete if triple not in self._aside],
            [triple for triple in insert if triple not in self._aside or triple in dropped],
        )
        self._aside.remove(dropped)
        return Change(change.others | {s for s, _, _ in dropped}, change.alike)

    def _apply(self, delete: list[Triple], insert: list[Triple]) -> Change:
        engine = self._engine
        if isinstance(engine, CompiledEngine):
            try:
                return engine.apply(delete, insert)
            except Refused as refused:
                raise Inconsistent(refused.explanation) from None
            except NotCompilable:  # undone
                gone, new = engine.without_idle_axioms(delete, insert)
                if len(gone) + len(new) < len(delete) + len(insert):
                    return self._apply(gone, new)
        return self._apply_anew(delete, insert, (), ())

    def believe(
        self,
        *,
        gone: Iterable[Triple] = (),
        come: Iterable[Triple] = (),
        aside: Iterable[Triple] = (),
        back: Iterable[Triple] = (),
        tell_implied: bool = False,
    ) -> Change:
        """Computed facts are gone and others come; asserted triples are set `aside`, or are `back`.

        What is computed holds, and is inferred rather than asserted. What is set aside is asserted and does
        not hold. Facts that are not there, or there already, change nothing.

        Returns those whose named classes changed; and what is `implied`, if that is to be told.

        Raises:
            Inconsistent: everything is as it was before.
        """
        gone, come, aside = list(gone), list(come), list(aside)
        back = [triple for triple in back if triple in self._aside]
        engine = self._engine
        try:
            if isinstance(engine, CompiledEngine):
                change = engine.believe(gone, come, aside, back, tell_implied=tell_implied)
            else:
                change = self._apply_anew(aside, back, gone, come)
        except Refused as refused:
            raise Inconsistent(refused.explanation) from None
        except NotCompilable:
            change = self._apply_anew(aside, back, gone, come)
        self._aside.remove(back)
        self._aside.add(aside)
        return change

    def _apply_anew(
        self,
        delete: Sequence[Triple],
        insert: Sequence[Triple],
        gone: Iterable[Triple],
        come: Iterable[Triple],
    ) -> Change:
        before = dict.fromkeys(self._engine.asserted(None, None, None))
        after = before.copy()
        for triple in delete:
            after.pop(triple, None)
        after.update(dict.fromkeys(insert))
        computed = dict.fromkeys(self.computed())
        for triple in gone:
            computed.pop(triple, None)
        computed.update(dict.fromkeys(come))
        engine = _engine_for(after, scattered=True, fast=self._fast, computed=computed)
        old, self._engine = self._engine, engine
        individuals = {s for s, _, _ in (*before, *after)} | {o for _, _, o in (*before, *after)}
        touched = {s for s, _, _ in before.keys() ^ after.keys()}
        touched |= {term for term in individuals if old.types(term) != engine.types(term)}
        return Change(frozenset(term for term in touched if not is_literal(term)))

    @contextmanager
    def supposing(self, triples: Iterable[Triple], *, anew: bool = True) -> Iterator[None]:
        """For the length of a `with`, what would be with some more triples; then all is as before.

        Unless `anew`, only what the compiled engine can try and take back at once is supposed.

        Raises:
            Inconsistent: they contradict the rest.
            NotCompilable: everything would have to be worked out anew, and that was not wanted.
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
                if not anew:
                    raise
            else:
                try:
                    yield
                finally:
                    engine.apply(new, ())
                return
        elif not anew:
            raise NotCompilable("the engine works everything out anew")
        said = engine.asserted(None, None, None)
        self._engine = _engine_for([*said, *new], fast=self._fast, computed=list(self.computed()))
        try:
            yield
        finally:
            self._engine = engine

    def asserted(
        self, s: Term | None = None, p: Term | None = None, o: Term | None = None
    ) -> Iterator[Triple]:
        """The asserted triples of a pattern, those that are set aside included."""
        found = self._engine.asserted(s, p, o)
        return chain(found, self._aside.match(s, p, o)) if self._aside else found

    def computed(
        self, s: Term | None = None, p: Term | None = None, o: Term | None = None
    ) -> Iterator[Triple]:
        """The computed triples of a pattern that are not asserted besides."""
        return self._engine.computed(s, p, o)

    def given(self, s: Term | None = None, p: Term | None = None, o: Term | None = None) -> Iterator[Triple]:
        """What holds by itself: the asserted triples of a pattern, not set aside, and the computed."""
        return chain(self._engine.asserted(s, p, o), self._engine.computed(s, p, o))

    def is_computed(self, triple: Triple) -> bool:
        """Whether a triple is computed, and not asserted."""
        return self._engine.is_computed(triple)

    def set_aside(self) -> Iterator[Triple]:
        """What is asserted and does not hold."""
        return iter(self._aside)

    @property
    def sets_aside(self) -> bool:
        """Whether anything is set aside."""
        return bool(self._aside)

    def set_aside_about(self, terms: Iterable[Term]) -> set[Triple]:
        """What is set aside and has one of the terms as its subject or object."""
        return self._aside.touching(terms)

    def held(self) -> Held:
        """All that is `given`, for a reasoner elsewhere: `Reasoner.of`."""
        return Held(list(self._engine.asserted(None, None, None)), list(self.computed()))

    @classmethod
    def of(cls, held: Held) -> Reasoner:
        """One in which the same holds; nothing is set aside there. Raises Inconsistent."""
        reasoner = cls(held.asserted)
        reasoner.believe(come=held.computed)
        return reasoner

    def by_subject(self) -> Iterator[list[Triple]]:
        """The asserted triples in groups of one subject, for whoever has no time to read all of them at once.

        The triples may change between two groups: one that is asserted all the while is among them, and one
        that is asserted at no time is not.
        """
        engine = self._engine
        if not isinstance(engine, CompiledEngine):
            return iter([list(self.asserted())])
        return chain(engine.by_subject(), map(list, (self._aside,)))

    def about(self, subject: Term) -> dict[Term, list[Term]]:
        """The asserted triples of a subject, predicate to objects. Costs as much as there is."""
        found = self._engine.about(subject)
        if self._aside:
            for _, predicate, object_ in self._aside.match(subject, None, None):
                found.setdefault(predicate, []).append(object_)
        return found

    def mentioned(self, terms: Set[Term]) -> set[Term]:
        """Those that a triple may have as its subject or object: what is not mentioned is new."""
        return self._engine.mentioned(terms) | self._aside.mentioned(terms)

    def inferred(
        self, s: Term | None = None, p: Term | None = None, o: Term | None = None
    ) -> Iterator[Triple]:
        """The triples about individuals that are computed or follow and were not asserted, of a pattern.

        Left out are classes without a name, and that everything is the same as itself; `holds` knows both.
        A value is given once, in its canonical spelling (`datatypes.canonical`), unless it was asserted in
        any spelling. What follows of classes and properties is given when the pattern's predicate asks
        for it.
        """
        return self._engine.inferred(s, p, o)

    def holds(self, triple: Triple) -> bool:
        """Whether a triple is asserted or computed, or follows; not if it is set aside."""
        return self._engine.holds(triple)

    def follows(self, triple: Triple) -> bool:
        """Whether a triple is computed or follows, and is not asserted, unless that is set aside."""
        return self._engine.holds(triple) and next(self._engine.asserted(*triple), None) is None

    def types(self, individual: Term) -> frozenset[Term]:
        """The named classes of an individual, asserted and inferred."""
        return self._engine.types(individual)

    def instances(self, cls: Term) -> Iterator[Term]:
        """The individuals of a class, asserted and inferred."""
        return self._engine.instances(cls)

    def superclasses(self, cls: Term) -> frozenset[Term]:
        """The named classes that a class is a subclass of, itself included."""
        wider = {o for source in (self.asserted, self.inferred) for _, _, o in source(cls, _SUB_CLASS_OF)}
        return frozenset(filter(is_named, wider)) | {cls}

    def subclasses(self, cls: Term) -> frozenset[Term]:
        """The named classes that are subclasses of a class, itself included."""
        narrower = {
            s for source in (self.asserted, self.inferred) for s, _, _ in source(None, _SUB_CLASS_OF, cls)
        }
        return frozenset(filter(is_named, narrower)) | {cls}

    def explain(self, triple: Triple) -> Explanation | None:
        """Why a triple holds; None when it does not."""
        return self._engine.explain(triple) if self.holds(triple) else None


def _engine_for(
    triples: Iterable[Triple],
    closed: Facts | None = None,
    scattered: bool = False,
    fast: bool = True,
    computed: Iterable[Triple] = (),
) -> CompiledEngine | GeneralEngine:
    """The fast engine if it knows all that the triples use, else the general one. Raises Inconsistent."""
    triples, computed = list(dict.fromkeys(triples)), list(computed)
    try:
        compiled = CompiledEngine(triples, closed, scattered=scattered, fast=fast)
        if computed:
            compiled.believe((), computed, (), (), tell_implied=False)
        return compiled
    except Refused as refused:
        raise Inconsistent(refused.explanation) from None
    except NotCompilable as reason:
        engine = GeneralEngine(triples, str(reason), computed)
    contradiction = engine.contradiction()
    if contradiction is not None:
        raise Inconsistent(contradiction)
    return engine
