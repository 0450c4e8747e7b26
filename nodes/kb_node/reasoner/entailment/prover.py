"""Entailment of facts: by the rules first, then by refutation and with generic individuals.

Every method returns True only if the statement holds in all models (OWL 2 RDF-Based Semantics), and False if
it found no proof. It uses three arguments:

- *Refutation*: a statement that contradicts the graph is false in all its models.
- *Generalisation*: a conclusion about a fresh individual holds for all individuals.
- *Witnesses*: naming a value that must exist adds nothing but the name.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import ExitStack
from functools import cached_property
from itertools import combinations, islice

from semmap.nodes.kb_node.reasoner import datatypes
from semmap.nodes.kb_node.reasoner.entailment.assumptions import WIDEST, Alternatives, membership_alternatives
from semmap.nodes.kb_node.reasoner.entailment.effort import Effort
from semmap.nodes.kb_node.reasoner.entailment.expressions import (
    And,
    AtLeast,
    AtMost,
    Expression,
    Has,
    Named,
    Not,
    OneOf,
    Only,
    Or,
    Reader,
    Role,
    Self,
    Unreadable,
    Writer,
    negated,
)
from semmap.nodes.kb_node.reasoner.explanations import Term, Triple
from semmap.nodes.kb_node.reasoner.reasoner import Inconsistent, Reasoner
from semmap.nodes.kb_node.reasoner.tbox.axioms import NotCompilable
from semmap.nodes.kb_node.reasoner.tbox.split import is_schema
from semmap.nodes.kb_node.reasoner.terms import (
    DIFFERENT_FROM,
    NOTHING,
    SAME_AS,
    THING,
    TYPE,
    iri,
    is_literal,
    is_named,
    is_reserved,
)

_DEEPEST = 6
"""Maximum nesting of expressions, definitions and case distinctions."""
_INDIVIDUALS = 300
"""Maximum number of individuals for which witnesses are named."""
_TOPS = (iri("owl:topObjectProperty"), iri("owl:topDataProperty"))
_BOTTOMS = (iri("owl:bottomObjectProperty"), iri("owl:bottomDataProperty"))


class Prover:
    """Proves facts about the graph of a reasoner. Every method restores the reasoner."""

    def __init__(self, reasoner: Reasoner, effort: Effort | None = None) -> None:
        self._reasoner = reasoner
        self._effort = effort or Effort()
        self._writer = Writer()
        self._depth = 0
        self._open: set[tuple[Term, Term]] = set()
        self._witnessed: set[Term] = set()
        self.reader = Reader(self.asserted)
        self.fresh = self._writer.fresh

    # Known facts

    def asserted(self, s: Term | None, p: Term | None, o: Term | None) -> list[Triple]:
        """Return the asserted triples of a pattern. They are copied because proofs change the reasoner."""
        found = list(self._reasoner.asserted(s, p, o))
        self._effort.note(found)
        return found

    def holds(self, triple: Triple) -> bool:
        """Return whether a triple follows by the rules."""
        if not self._reasoner.holds(triple):
            return False
        self._effort.note_conclusion(self._reasoner, triple)
        return True

    def _known(self, s: Term | None, p: Term | None, o: Term | None, most: int | None = None) -> list[Triple]:
        """Return the asserted and the inferred triples of a pattern, at most `most` of each."""
        asserted = list(islice(self._reasoner.asserted(s, p, o), most))
        inferred = list(islice(self._reasoner.inferred(s, p, o), most))
        self._effort.note(asserted)
        for triple in inferred:
            self._effort.note_conclusion(self._reasoner, triple)
        return asserted + inferred

    # Assumptions

    def refutes(self, *assumed: Triple) -> bool:
        """Return whether some triples contradict the graph."""
        return self.follows(assumed, lambda: False)

    def follows(self, assumed: Iterable[Triple], goal: Callable[[], bool]) -> bool:
        """Return whether a goal is reached if triples are assumed. A contradiction entails every goal."""
        assumed = [triple for triple in assumed if not is_literal(triple[0])]  # fewer assumptions are sound
        facts = [triple for triple in assumed if not is_schema(triple)]
        ends = (term for s, p, o in facts for term in ((s,) if p == TYPE or is_literal(o) else (s, o)))
        things = dict.fromkeys(ends)
        assumed += [(x, TYPE, THING) for x in things]
        assumed += [(x, p, x) for p in self._reflexive() for x in things]
        if any(p in _BOTTOMS for _, p, _ in assumed):
            return True
        if not self._effort.may_assume():
            return False
        try:
            with self._reasoner.assuming(assumed, allow_recompute=self._effort.allow_recompute):
                return goal()
        except Inconsistent as found:
            self._effort.note(found.explanation.support)
            return True
        except NotCompilable:  # `allow_recompute` is False: no proof is found
            return False

    def follows_from_each(self, alternatives: Alternatives, goal: Callable[[], bool]) -> bool:
        """Return whether a goal is reached with each of the alternatives."""
        return all(self.follows(assumed, goal) for assumed in alternatives)

    def membership_alternatives(self, x: Term, expression: Expression) -> Alternatives:
        """Return the alternatives that x is a member of a class."""
        return membership_alternatives(x, expression, self._writer)

    # Facts

    def fact(self, triple: Triple) -> bool:
        """Return whether a triple about individuals follows."""
        s, p, o = triple
        if self.holds(triple) or p in _TOPS:
            return True
        if p == TYPE:
            try:
                return self.member(s, self.reader.expression(o))
            except Unreadable:
                return False
        if p == DIFFERENT_FROM:
            return self.different(s, o)
        if p == SAME_AS:
            return self.refutes((s, DIFFERENT_FROM, o))
        return s == o and self._is_reflexive(s, p)

    def different(self, x: Term, y: Term) -> bool:
        """Return whether two terms are different: literals by value, others also by refutation."""
        if is_literal(x) and is_literal(y):
            one, other = datatypes.value(x), datatypes.value(y)
            return one is not None and other is not None and one != other
        if is_literal(x):
            x, y = y, x
        return self.holds((x, DIFFERENT_FROM, y)) or self.refutes((x, SAME_AS, y))

    def member(self, x: Term, expression: Expression) -> bool:
        """Return whether x is in a class."""
        if self._depth >= _DEEPEST or self._effort.is_over:
            return False
        self._depth += 1
        try:
            return (
                self._member(x, expression)
                or self._with_own_witnesses(x, lambda: self._member(x, expression))
                or self._by_cases(x, expression)
            )
        finally:
            self._depth -= 1

    def _member(self, x: Term, expression: Expression) -> bool:
        match expression:
            case Named(term):
                return self._in_named(x, term)
            case And(parts):
                return all(self.member(x, part) for part in parts)
            case Or(parts):
                if any(self.member(x, part) for part in parts):
                    return True
                return self.follows_from_each(
                    self.membership_alternatives(x, negated(expression)), lambda: False
                )
            case OneOf(terms):
                return any(self.holds((x, SAME_AS, term)) for term in terms)
            case Has(role, value):
                return self._edge(role, x, value)
            case Self(role):
                return self._edge(role, x, x)
            case Only(role, filler):
                y = self.fresh()  # generalisation: stands for any value of x
                return self.follows([role.edge(x, y)], lambda: self.member(y, filler))
            case AtLeast(number, role, filler):
                return self._has_values(x, number, role, filler)
            case Not() | AtMost():
                return self.follows_from_each(
                    self.membership_alternatives(x, negated(expression)), lambda: False
                )

    def _in_named(self, x: Term, cls: Term) -> bool:
        """Return whether x is in a named class, by the rules or by a sufficient condition of the class."""
        if cls == THING or self.holds((x, TYPE, cls)):
            return True
        if datatypes.is_datatype(cls):
            return self._has_datatype(x, cls)
        if (x, cls) in self._open:
            return False
        self._open.add((x, cls))
        try:
            return any(self.member(x, definition) for definition in self._sufficient(cls))
        finally:
            self._open.remove((x, cls))

    def _has_datatype(self, x: Term, datatype: Term) -> bool:
        if is_literal(x):
            return datatypes.contains(datatype, x)
        inferred = [known for known in datatypes.known() if self.holds((x, TYPE, known))]
        return datatypes.includes_common(datatype, inferred)

    def _sufficient(self, cls: Term) -> Iterator[Expression]:
        """Yield expressions that are subclasses of a class. Equivalent classes are subclasses, too."""
        narrower = (s for s, _, _ in self._known(None, iri("rdfs:subClassOf"), cls))
        for node in dict.fromkeys((cls, *narrower)):
            if node != cls and is_named(node) and node != NOTHING:
                yield Named(node)
            try:
                yield from list(self.reader.definitions(node))
            except Unreadable:
                continue

    def _has_values(self, x: Term, number: int, role: Role, filler: Expression) -> bool:
        """Return whether x has `number` different values in a class."""
        if number <= 0:
            return True
        found = [y for y in self.values(x, role) if self.member(y, filler)]
        if number == 1 and found:
            return True
        return any(
            all(self.different(one, other) for one, other in combinations(chosen, 2))
            for chosen in islice(combinations(found, number), 200)
        )

    def values(self, x: Term, role: Role) -> list[Term]:
        """Return the known values of a role at x, up to a limit."""
        s, o = (None, x) if role.backwards else (x, None)
        found: dict[Term, None] = {}
        for triple in self._known(s, role.property, o, most=WIDEST):
            found[triple[0 if role.backwards else 2]] = None
        return list(found)

    def _edge(self, role: Role, x: Term, y: Term) -> bool:
        edge = role.edge(x, y)
        return not is_literal(edge[0]) and self.fact(edge)

    def _is_reflexive(self, x: Term, prop: Term) -> bool:
        """Return whether the property or a subproperty is reflexive, or a class of x implies the relation."""
        below = {prop}
        below.update(s for s, _, _ in self._known(None, iri("rdfs:subPropertyOf"), prop))
        reflexive = iri("owl:ReflexiveProperty")
        if any(self.holds((narrow, TYPE, reflexive)) for narrow in below):
            return True
        return any(
            on in below and self.holds((x, TYPE, node))
            for node, _, _ in self.asserted(None, iri("owl:hasSelf"), None)
            for _, _, on in self.asserted(node, iri("owl:onProperty"), None)
        )

    # Cases

    def _by_cases(self, x: Term, goal: Expression) -> bool:
        """Return whether x is in a class in each case of a union or enumeration that contains x."""
        if self._depth > 2 or is_literal(x):
            return False
        for expression in self._disjunctions(x):
            if self.follows_from_each(
                self.membership_alternatives(x, expression), lambda: self.member(x, goal)
            ):
                return True
        return False

    def _disjunctions(self, x: Term) -> Iterator[Expression]:
        """Yield the unions and enumerations that contain x, if it is not known which of their parts does."""
        for name in ("owl:unionOf", "owl:oneOf"):
            for node, _, head in self.asserted(None, iri(name), None):
                if not self.holds((x, TYPE, node)):
                    continue
                try:
                    members = self.reader.members(head)
                    decided = TYPE if name == "owl:unionOf" else SAME_AS
                    if not any(self.holds((x, decided, member)) for member in members):
                        yield from list(self.reader.definitions(node))
                except Unreadable:
                    continue

    # Witnesses

    def _with_own_witnesses(self, x: Term, goal: Callable[[], bool]) -> bool:
        """Return whether a goal is reached after naming the values that x must have."""
        if x in self._witnessed or is_literal(x):
            return False
        new = list(self._must_exist([x]))
        if all(map(self.holds, new)):
            return False
        self._witnessed.add(x)
        try:
            return self.follows(new, goal)
        finally:
            self._witnessed.remove(x)

    def with_witnesses(self, mentioned: Iterable[Term], goal: Callable[[], bool]) -> bool:
        """Return whether a goal is reached after naming the values that must exist, in two steps."""
        with ExitStack() as stack:
            individuals = list(dict.fromkeys([*self._individuals(), *mentioned]))
            try:
                for _ in range(2):
                    if self._effort.is_over:
                        break
                    new = list(self._must_exist(individuals))
                    stack.enter_context(
                        self._reasoner.assuming(new, allow_recompute=self._effort.allow_recompute)
                    )
                    individuals = [
                        term for term in {s: 0 for t in new for s in (t[0], t[2])} if term[0] != '"'
                    ][:_INDIVIDUALS]
            except Inconsistent as found:
                self._effort.note(found.explanation.support)
                return True
            except NotCompilable:
                return False
            return goal()

    def is_unsatisfiable(self, cls: Term) -> bool:
        """Return whether a class is unsatisfiable: a member with its necessary values is a contradiction."""
        self._effort.reset()
        x = self.fresh()
        return self.follows([(x, TYPE, cls)], lambda: self._has_impossible_witnesses([x], steps=2))

    def _has_impossible_witnesses(self, individuals: Sequence[Term], steps: int) -> bool:
        if steps == 0:
            return False
        new = list(self._must_exist(individuals, self._known_existential))
        further = [term for triple in new for term in triple[::2] if term not in individuals]
        return self.follows(
            new, lambda: self._has_impossible_witnesses([t for t in further if t[0] == "_"], steps - 1)
        )

    @cached_property
    def _known_existential(self) -> list[tuple[Term, Expression]]:
        return list(self._existential())

    def _individuals(self) -> list[Term]:
        schema = {s for s, _, _ in self._reasoner.asserted(None, TYPE, iri("owl:Class"))}
        found: dict[Term, None] = {}
        for s, p, o in self._reasoner.asserted():
            if not is_reserved(p):
                found.update({s: None, o: None})
            elif p == TYPE and not is_reserved(o):
                found[s] = None
            if len(found) > _INDIVIDUALS:
                break
        return [term for term in found if term not in schema and not is_literal(term)]

    def _must_exist(
        self, individuals: Sequence[Term], wanted: Sequence[tuple[Term, Expression]] | None = None
    ) -> Iterator[Triple]:
        """Yield fresh values of existential restrictions, reflexive edges, and membership in owl:Thing."""
        wanted = list(self._existential()) if wanted is None else wanted
        reflexive = self._reflexive()
        for x in individuals:
            if self._effort.is_over:  # fewer assumptions are sound
                return
            for node, expression in wanted:
                if (node == THING or self.holds((x, TYPE, node))) and not self._is_met(x, expression):
                    alternatives = self.membership_alternatives(x, expression)
                    if len(alternatives) == 1:
                        yield from alternatives[0]
            yield from ((x, p, x) for p in reflexive)
            yield (x, TYPE, THING)

    def _is_met(self, x: Term, expression: Expression) -> bool:
        """Return whether a known value of x meets a restriction, so that no new value is named.

        A new name for a literal would require recomputing everything.
        """
        match expression:
            case AtLeast(1, role, Named(term)):
                return any(self._is_in(y, term) for y in self.values(x, role))
        return False

    def _is_in(self, y: Term, term: Term) -> bool:
        if is_literal(y):
            return term == THING or self._has_datatype(y, term)
        return term == THING or self.holds((y, TYPE, term))

    def _reflexive(self) -> list[Term]:
        return [p for p, _, _ in self.asserted(None, TYPE, iri("owl:ReflexiveProperty"))]

    def _existential(self) -> Iterator[tuple[Term, Expression]]:
        nodes: dict[Term, None] = {}
        for name in _EXISTENTIAL:
            nodes.update(dict.fromkeys(s for s, _, _ in self.asserted(None, iri(name), None)))
        for node in nodes:
            try:
                for expression in self.reader.definitions(node):
                    positive = expression.parts if isinstance(expression, And) else (expression,)
                    yield from ((node, part) for part in positive if isinstance(part, AtLeast | Self | OneOf))
            except Unreadable:
                continue


_EXISTENTIAL = (
    "owl:someValuesFrom", "owl:minCardinality", "owl:minQualifiedCardinality", "owl:cardinality",
    "owl:qualifiedCardinality", "owl:hasSelf", "owl:oneOf",
)  # fmt: skip
