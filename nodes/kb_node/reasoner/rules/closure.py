"""Forward chaining with the rule table on a graph. Every fact is stored with its reason.

It is exact and general, but slower than `abox.py`. It closes the schema (a few thousand facts), reasons on
graphs that the compiled engine does not support, proves explanations, and is the reference in tests of the
compiled engine.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from functools import cache
from itertools import combinations

from semmap.nodes.kb_node.reasoner import datatypes
from semmap.nodes.kb_node.reasoner.data_ranges import Definition, read_all
from semmap.nodes.kb_node.reasoner.explanations import Term, Triple
from semmap.nodes.kb_node.reasoner.lexical_forms import Value
from semmap.nodes.kb_node.reasoner.rules import builtins, swrl
from semmap.nodes.kb_node.reasoner.rules.facts import Facts, Reason
from semmap.nodes.kb_node.reasoner.rules.matching import Pattern, Plan, bind, pattern, patterns, plan, unify
from semmap.nodes.kb_node.reasoner.rules.rule_table import AXIOMS, NUMBERS, RULES, Atom, Rule
from semmap.nodes.kb_node.reasoner.rules.time_limit import TimeLimit
from semmap.nodes.kb_node.reasoner.terms import DIFFERENT_FROM, FIRST, REST, SAME_AS, TYPE, is_literal


class Closure(Facts):
    """A graph and all its conclusions, up to the first contradiction."""

    def __init__(
        self, triples: Iterable[Triple] = (), base: Closure | None = None, mentions: Iterable[Term] = ()
    ) -> None:
        """Close a graph.

        `base` is a closure to start from; it is not changed. `mentions` are terms of later queries, which
        need not be in the graph.
        """
        base = base or _empty()
        self.clash: Reason | None = base.clash
        self.facts: dict[Triple, Reason | None] = base.facts.copy()
        self._index: dict[Pattern, dict[Triple, None]] = {k: v.copy() for k, v in base._index.items()}
        self._triggers: dict[Pattern, list[Plan]] = {k: list(v) for k, v in base._triggers.items()}
        self._watchers: dict[Pattern, list[Rule]] = {k: list(v) for k, v in base._watchers.items()}
        self._literals: dict[Value, list[Term]] = {k: list(v) for k, v in base._literals.items()}
        self._datatypes: list[Term] = list(base._datatypes)
        self._compared: list[Term] = list(base._compared)
        self._ranges: dict[Term, Definition] = dict(base._ranges)
        self._mentions: dict[Term, Triple] = dict(base._mentions)
        self._agenda: deque[Triple] = deque()
        for term in mentions:
            self._register(term)
        self.insert(triples)

    def insert(self, triples: Iterable[Triple]) -> None:
        """Assert triples and draw all conclusions. Stops at the first contradiction and sets `clash`.

        A list must be complete when the triple that refers to it is inserted, or in the same call.
        """
        for triple in sorted(triples, key=_cells_first):
            if triple not in self.facts:
                self._add(triple, None)
            else:
                self.facts[triple] = None
        while self._agenda and self.clash is None:
            self._fire(self._agenda.popleft())
            if not self._agenda:
                self._read_ranges()
                self._apply_swrl()

    # Facts

    def _add(self, fact: Triple, reason: Reason | None) -> None:
        if fact in self.facts:
            return
        self.facts[fact] = reason
        self._agenda.append(fact)
        if reason is None and is_literal(fact[2]):
            self._mentions.setdefault(fact[2], fact)
        for term in fact:
            self._register(term)
            if is_literal(term) and datatypes.is_ill_typed(term):
                self._conclude("dt-not-type", (fact,), None)
        s, p, o = fact
        if p == TYPE and is_literal(s) and datatypes.is_datatype(o) and datatypes.excludes(o, s):
            self._reject((fact,))
        if p == TYPE and is_literal(s) and o in self._ranges:
            self._exclude(fact)
        if p == SAME_AS and is_literal(o) and s != o:
            self._add_differences(fact)

    def _read_ranges(self) -> None:
        """Apply table 8 to data ranges that the graph defines: restrictions, enumerations, combinations."""
        for node, definition in read_all(self.match).items():
            if node not in self._ranges:
                self._ranges[node] = definition
                for same in list(self._literals.values()):
                    for literal in same:
                        self._include(literal, node)
                for fact in list(self.match(None, TYPE, node)):
                    if is_literal(fact[0]):
                        self._exclude(fact)

    def _include(self, literal: Term, node: Term) -> None:
        data_range, definition = self._ranges[node]
        if data_range.contains(literal):
            self._add((literal, TYPE, node), Reason("dt-type2", tuple(definition)))

    def _exclude(self, fact: Triple) -> None:
        data_range, definition = self._ranges[fact[2]]
        if data_range.contains(fact[0]) is False:
            self._reject((fact, *definition))

    def _reject(self, premises: tuple[Triple, ...]) -> None:
        """Note that a literal is not in its datatype, with a triple that mentions it (dt-not-type)."""
        literal = premises[0][0]
        mention = self._mentions.get(literal)
        if mention is not None and not any(literal in leaf for leaf in self.leaves(premises[0])):
            premises += (mention,)  # the datatypes alone contradict each other only about a given value
        self._conclude("dt-not-type", premises, None)

    def _register(self, term: Term) -> None:
        """Apply table 8 to a new term, as far as it matters for this graph."""
        if datatypes.is_datatype(term) and term not in self._datatypes:
            self._datatypes.append(term)
            for same in list(self._literals.values()):
                for known in same:
                    self._type(known, (term,))
        value = datatypes.value(term) if is_literal(term) else None
        if value is not None and term not in (same := self._literals.setdefault(value, [])):
            for other in same:
                self._add((term, SAME_AS, other), Reason("dt-eq", ()))
                self._add((other, SAME_AS, term), Reason("dt-eq", ()))
            same.append(term)
            self._type(term, self._datatypes)
            for node in self._ranges:
                self._include(term, node)

    def _type(self, literal: Term, candidates: Sequence[Term]) -> None:
        for datatype in candidates:
            if datatypes.contains(datatype, literal):
                self._add((literal, TYPE, datatype), Reason("dt-type2", ()))

    def _add_differences(self, fact: Triple) -> None:
        """Add the types and differences of a literal that is in a sameAs fact (dt-diff)."""
        literal = fact[2]
        self._type(literal, datatypes.datatypes(literal))
        value = datatypes.value(literal)
        if value is None or literal in self._compared:
            return
        for other in self._compared:
            if datatypes.value(other) != value:
                self._add((literal, DIFFERENT_FROM, other), Reason("dt-diff", ()))
                self._add((other, DIFFERENT_FROM, literal), Reason("dt-diff", ()))
        self._compared.append(literal)

    # Rules

    def _apply_swrl(self) -> None:
        """Apply the SWRL rules of the graph to all facts."""
        if (None, TYPE, swrl.RULE) not in self._index:
            return
        for rule in swrl.read(self).supported:
            for bound, premises in list(self._match_swrl(rule.body, {})):
                head: Triple | None = None
                if rule.head is not None:
                    ends = [bound.get(argument, argument) for argument in rule.head.arguments]
                    head = _triple(rule.head, ends)
                    if head in self.facts or (rule.head.kind == swrl.SAME and ends[0] == ends[1]):
                        continue
                if head is None or not is_literal(head[0]):
                    self._conclude("swrl", (*premises, *rule.triples), head)

    def matches(self, rule: swrl.SwrlRule, limit: TimeLimit) -> Iterator[tuple[Term, ...]]:
        """Yield the values of the variables of each match of a SWRL rule. Raises OutOfTime at the limit."""
        return (tuple(bound.values()) for bound, _ in self._match_swrl(rule.body, {}, limit))

    def _match_swrl(
        self, atoms: Sequence[swrl.Atom], bound: dict[Term, Term], limit: TimeLimit | None = None
    ) -> Iterator[tuple[dict[Term, Term], tuple[Triple, ...]]]:
        """Yield the matches of the atoms of a SWRL rule, with the facts that they need."""
        if limit is not None:
            limit.check()
        if not atoms:
            yield bound, ()
            return
        for more, facts in self._match_swrl_atom(atoms[0], bound):
            for found, others in self._match_swrl(atoms[1:], {**bound, **more}, limit):
                yield found, (*facts, *others)

    def _match_swrl_atom(
        self, atom: swrl.Atom, bound: dict[Term, Term]
    ) -> Iterator[tuple[dict[Term, Term], tuple[Triple, ...]]]:
        ends = [bound.get(argument, argument) for argument in atom.arguments]
        if atom.kind == swrl.BUILT_IN:
            if builtins.is_comparison(atom.predicate):
                if builtins.compare(atom.predicate, *ends):
                    yield {}, ()
            elif (found := builtins.calculate(atom.predicate, ends[1:])) is not None:
                if swrl.is_variable(ends[0]):
                    yield {ends[0]: found}, ()
                elif builtins.is_equal(ends[0], found):
                    yield {}, ()
            return
        if atom.kind == swrl.SAME and ends[0] == ends[1]:
            yield {}, ()
            return
        if atom.kind == swrl.DIFFERENT:
            same = [[end, *(fact[2] for fact in self.match(end, SAME_AS))] for end in ends]
            for listed, axiom in swrl.read_all_different(self):
                if not any(map(listed.isdisjoint, same)) and set(same[0]).isdisjoint(same[1]):
                    equal = {(end, SAME_AS, member) for end, *members in same for member in members}
                    yield {}, (*equal, *axiom)
                    return
        for s, p, o in {_triple(atom, ends), _triple(atom, ends[::-1] if _is_symmetric(atom) else ends)}:
            wanted = (None if swrl.is_variable(s) else s, p, None if swrl.is_variable(o) else o)
            for fact in self.match(*wanted):
                if s != o or fact[0] == fact[2]:
                    yield {term: fact[i] for i, term in ((0, s), (2, o)) if swrl.is_variable(term)}, (fact,)

    def _watch(self, rule: Rule) -> None:
        """Activate a rule for present and future facts."""
        if not rule.schema:
            self._start(rule)
            return
        atom = rule.schema[0]
        if atom[1] in ("in", "of"):
            for bindings, cells in self._choices(atom):
                self._watch(bind(rule, bindings, cells))
            return
        self._watchers.setdefault(pattern(atom), []).append(rule)
        for fact in list(self.match(*pattern(atom))):
            self._specialise(rule, fact)

    def _specialise(self, rule: Rule, fact: Triple) -> None:
        bindings = unify(rule.schema[0], fact)
        if bindings is not None:
            self._watch(bind(rule, bindings, (fact,)))

    def _choices(self, atom: Atom) -> Iterator[tuple[dict[str, Term], tuple[Triple, ...]]]:
        """Yield the choices of list members for an atom."""
        names, _, head = atom
        members, cells = self.members(head) or ([], ())
        variables = names.split(",")
        for choice in combinations(members, len(variables)):
            yield dict(zip(variables, choice, strict=True)), cells

    def _start(self, rule: Rule) -> None:
        """Activate a rule whose schema atoms are all matched."""
        rule = self._without_lists(rule)
        data = tuple(atom for atom in rule.data if not (atom[1] == SAME_AS and atom[0] == atom[2]))
        for i, atom in enumerate(data):
            self._triggers.setdefault(pattern(atom), []).append(plan(rule, data, i))
        whole = plan(rule, data)
        self._join(whole, 0, [""] * whole.variables, ())

    def _without_lists(self, rule: Rule) -> Rule:
        """Expand the list atoms `all`, `path` and `agree` member by member."""
        data: list[Atom] = []
        premises = rule.premises
        for s, p, o in rule.data:
            kind, _, head = next((w for w in (p, o) if w.endswith(")")), "").rstrip(")").partition("(")
            members, cells = (self.members(head) if kind else None) or ([], ())
            premises += cells
            if kind == "all":
                data += [(s, p, member) for member in members]
            elif kind == "path":
                stops = [s, *(f"?{i}" for i in range(1, len(members))), o]
                data += [(stops[i], member, stops[i + 1]) for i, member in enumerate(members)]
            elif kind == "agree":
                data += [(subject, member, f"?{i}") for i, member in enumerate(members) for subject in (s, o)]
            if not members:
                data.append((s, p, o))  # not a list atom, or not a list: then nothing matches it
        return rule._replace(data=tuple(data), premises=premises)

    def _fire(self, fact: Triple) -> None:
        """Index a fact, and join it with the facts indexed before. Each pair is joined once."""
        self._note(fact)
        for key in patterns(fact):
            for found in list(self._triggers.get(key, ())):
                self._match_atom(found, 0, fact, [""] * found.variables, ())
        for key in patterns(fact):
            for rule in list(self._watchers.get(key, ())):
                self._specialise(rule, fact)

    def _join(self, found: Plan, at: int, known: list[Term], premises: tuple[Triple, ...]) -> None:
        """Match the atoms of a rule from a position on, and apply the rule to each match."""
        if at == len(found.accesses):
            self._apply(found, known, premises)
            return
        s, p, o = found.accesses[at].key
        key = (
            known[s] if isinstance(s, int) else s,
            known[p] if isinstance(p, int) else p,
            known[o] if isinstance(o, int) else o,
        )
        for fact in self.match(*key):
            self._match_atom(found, at, fact, known, premises)

    def _match_atom(
        self, found: Plan, at: int, fact: Triple, known: list[Term], premises: tuple[Triple, ...]
    ) -> None:
        """Match a fact with an atom, bind its variables, and continue with the next atom."""
        access = found.accesses[at]
        for one, other in access.repeats:
            if fact[one] != fact[other]:
                return
        for variable, place in access.binds:
            known[variable] = fact[place]
        if at + 1 == len(found.accesses):
            self._apply(found, known, (*premises, fact))
        else:
            self._join(found, at + 1, known, (*premises, fact))

    def _apply(self, found: Plan, known: list[Term], matched: tuple[Triple, ...]) -> None:
        head: Triple | None = None
        if found.head is not None:
            s, p, o = found.head
            head = (
                known[s] if isinstance(s, int) else s,
                known[p] if isinstance(p, int) else p,
                known[o] if isinstance(o, int) else o,
            )
            if head in self.facts or (head[1] == SAME_AS and head[0] == head[2]):
                return
        premises = sorted(zip(found.places, matched, strict=True))
        self._conclude(found.rule.name, (*(fact for _, fact in premises), *found.rule.premises), head)

    def _conclude(self, rule: str, premises: tuple[Triple, ...], head: Triple | None) -> None:
        reason = Reason(rule, tuple(dict.fromkeys(premises)))
        if head is not None:
            self._add(head, reason)
        elif self.clash is None:
            self.clash = reason


class _Empty(Closure):
    """The axiomatic triples, with all rules active."""

    def __init__(self) -> None:
        self.clash, self.facts, self._agenda = None, {}, deque()
        self._index, self._triggers, self._watchers = {}, {}, {}
        self._literals, self._datatypes, self._compared = {}, [], []
        self._ranges, self._mentions = {}, {}
        for number in NUMBERS:
            self._register(number)
        for rule in RULES:
            self._watch(rule)
        for axiom, name in AXIOMS.items():
            self._add(axiom, Reason(name, ()))
        self.insert(())


def _triple(atom: swrl.Atom, ends: Sequence[Term]) -> Triple:
    if atom.kind == swrl.CLASS:
        return (ends[0], TYPE, atom.predicate)
    predicate = {swrl.SAME: SAME_AS, swrl.DIFFERENT: DIFFERENT_FROM}.get(atom.kind, atom.predicate)
    return (ends[0], predicate, ends[-1])


def _is_symmetric(atom: swrl.Atom) -> bool:
    return atom.kind == swrl.DIFFERENT


@cache
def _empty() -> Closure:
    return _Empty()


def _cells_first(triple: Triple) -> bool:
    return triple[1] not in (FIRST, REST)
