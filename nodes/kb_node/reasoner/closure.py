"""The rule table applied to a graph as it stands: forward chaining, every fact stored with its reason.

Exact and general, and slow beside `abox.py`: it closes the schema (a few thousand facts), carries graphs that
use the vocabulary in ways the compiled engine does not know, proves what an explanation claims, and is what
the compiled engine is tested against.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from itertools import combinations
from typing import NamedTuple

from nodes.kb_node.reasoner import datatypes
from nodes.kb_node.reasoner.rules import AXIOMS, DECLARATIONS, NUMBERS, RULES, Atom, Rule
from nodes.kb_node.reasoner.terms import DIFFERENT_FROM, FIRST, NIL, REST, SAME_AS, TYPE, is_literal
from schemas.explanations import Term, Triple

Pattern = tuple[Term | None, Term | None, Term | None]
Bindings = dict[str, Term]


class Reason(NamedTuple):
    """Why a fact holds: a rule and the facts it was applied to. Asserted facts have None instead."""

    rule: str
    premises: tuple[Triple, ...]


class _Trigger(NamedTuple):
    """A rule as seen from one of its data atoms: that atom, and the others in the order to join them."""

    rule: Rule
    atom: Atom
    others: tuple[Atom, ...]


class Closure:
    """A graph and all that follows from it, until a contradiction is met."""

    def __init__(self, triples: Iterable[Triple] = ()) -> None:
        self.facts: dict[Triple, Reason | None] = {}
        self.clash: Reason | None = None
        self._index: dict[Pattern, dict[Triple, None]] = {}
        self._triggers: dict[Pattern, list[_Trigger]] = {}
        self._watchers: dict[Pattern, list[Rule]] = {}
        self._agenda: deque[Triple] = deque()
        self._literals: dict[datatypes.Value, list[Term]] = {}
        self._datatypes: list[Term] = []
        self._compared: list[Term] = []
        for number in NUMBERS:
            self._meet(number)
        for rule in RULES:
            self._watch(rule)
        for axiom, name in AXIOMS.items():
            self._add(axiom, Reason(name, ()))
        self.insert(triples)

    def insert(self, triples: Iterable[Triple]) -> None:
        """Assert triples and draw all conclusions, or stop at the first clash (`clash` is set then).

        Lists must be complete when the triple that owns them arrives, at the latest in the same call.
        """
        for triple in sorted(triples, key=_cells_first):
            if triple not in self.facts:
                self._add(triple, None)
            else:
                self.facts[triple] = None
        while self._agenda and self.clash is None:
            self._fire(self._agenda.popleft())

    def match(self, s: Term | None = None, p: Term | None = None, o: Term | None = None) -> Iterable[Triple]:
        """All facts of a pattern; None is a wildcard."""
        if s is not None and p is not None and o is not None:
            return ((s, p, o),) if (s, p, o) in self.facts else ()
        if s is None and p is None and o is None:
            return self.facts
        if s is not None and o is not None:
            return [fact for fact in self._index.get((s, None, None), ()) if fact[2] == o]
        return self._index.get((s, p, o), ())

    def holds(self, triple: Triple) -> bool:
        """Whether a triple follows. Everything is the same as itself (eq-ref)."""
        s, p, o = triple
        return triple in self.facts or triple in DECLARATIONS or (p == SAME_AS and s == o)

    # Facts

    def _add(self, fact: Triple, reason: Reason | None) -> None:
        if fact in self.facts:
            return
        self.facts[fact] = reason
        s, p, o = fact
        for pattern in ((s, None, None), (None, p, None), (None, None, o), (s, p, None), (None, p, o)):
            self._index.setdefault(pattern, {})[fact] = None
        self._agenda.append(fact)
        for term in fact:
            self._meet(term)
            if is_literal(term) and datatypes.is_ill_typed(term):
                self._conclude("dt-not-type", (fact,), None)
        if p == TYPE and is_literal(s) and datatypes.is_datatype(o) and not datatypes.contains(o, s):
            self._conclude("dt-not-type", (fact,), None)
        if p == SAME_AS and is_literal(o) and s != o:
            self._tell_apart(fact)

    def _meet(self, term: Term) -> None:
        """Table 8, as far as the graph at hand can tell the difference, when a term is first seen."""
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

    def _type(self, literal: Term, candidates: Sequence[Term]) -> None:
        for datatype in candidates:
            if datatypes.contains(datatype, literal):
                self._add((literal, TYPE, datatype), Reason("dt-type2", ()))

    def _tell_apart(self, fact: Triple) -> None:
        """Literals that something is the same as get all their types, and their differences (dt-diff)."""
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

    def _watch(self, rule: Rule) -> None:
        """Put a rule to work: on the facts at hand, and on those to come."""
        if not rule.schema:
            self._ready(rule)
            return
        atom = rule.schema[0]
        if atom[1] in ("in", "of"):
            for special in self._by_members(rule):
                self._watch(special)
            return
        pattern = _pattern(atom, {})
        self._watchers.setdefault(pattern, []).append(rule)
        for fact in list(self.match(*pattern)):
            self._specialise(rule, fact)

    def _specialise(self, rule: Rule, fact: Triple) -> None:
        bindings = _unify(rule.schema[0], fact, {})
        if bindings is not None:
            self._watch(_bind(rule, rule.schema[1:], bindings, (fact,)))

    def _by_members(self, rule: Rule) -> Iterator[Rule]:
        names, _, head = rule.schema[0]
        members, cells = self._list(head) or ([], ())
        variables = names.split(",")
        for choice in combinations(members, len(variables)):
            yield _bind(rule, rule.schema[1:], dict(zip(variables, choice, strict=True)), cells)

    def _ready(self, rule: Rule) -> None:
        """Start a rule whose schema atoms are all matched."""
        written_out = self._without_lists(rule)
        if written_out is None:
            return
        rule = written_out
        data = tuple(atom for atom in rule.data if not (atom[1] == SAME_AS and atom[0] == atom[2]))
        for i, atom in enumerate(data):
            trigger = _Trigger(rule, atom, _join_order(atom, data[:i] + data[i + 1 :]))
            self._triggers.setdefault(_pattern(atom, {}), []).append(trigger)
        for bindings, premises in list(self._join(data, {}, ())):
            self._apply(rule, bindings, premises)

    def _without_lists(self, rule: Rule) -> Rule | None:
        """Write the list atoms `all`, `path`, `agree` out, member by member; None without such a list."""
        data: list[Atom] = []
        premises = rule.premises
        for s, p, o in rule.data:
            kind, _, head = next((w for w in (p, o) if w.endswith(")")), "").rstrip(")").partition("(")
            found = self._list(head) if kind else ([], ())
            if found is None:
                return None
            members, cells = found
            premises += cells
            if kind == "all":
                data += [(s, p, member) for member in members]
            elif kind == "path":
                stops = [s, *(f"?{i}" for i in range(1, len(members))), o]
                data += [(stops[i], member, stops[i + 1]) for i, member in enumerate(members)]
            elif kind == "agree":
                data += [(who, member, f"?{i}") for i, member in enumerate(members) for who in (s, o)]
            else:
                data.append((s, p, o))
        return rule._replace(data=tuple(data), premises=premises)

    def _list(self, head: Term) -> tuple[list[Term], tuple[Triple, ...]] | None:
        """Members and cells of an asserted list; None when it is cut off, branches or runs in a circle."""
        members: list[Term] = []
        cells: list[Triple] = []
        while head != NIL:
            first = [fact for fact in self.match(head, FIRST) if self.facts[fact] is None]
            rest = [fact for fact in self.match(head, REST) if self.facts[fact] is None]
            if len(first) != 1 or len(rest) != 1 or rest[0] in cells:
                return None
            members.append(first[0][2])
            cells += (first[0], rest[0])
            head = rest[0][2]
        return members, tuple(cells)

    def _fire(self, fact: Triple) -> None:
        s, p, o = fact
        for pattern in (
            (None, p, None), (None, p, o), (s, p, None), (None, None, None), (s, None, None),
            (None, None, o), (s, p, o), (s, None, o),
        ):  # fmt: skip
            for rule in list(self._watchers.get(pattern, ())):
                self._specialise(rule, fact)
            for trigger in list(self._triggers.get(pattern, ())):
                bindings = _unify(trigger.atom, fact, {})
                if bindings is not None:
                    for found, premises in list(self._join(trigger.others, bindings, (fact,))):
                        self._apply(trigger.rule, found, premises)

    def _join(
        self, atoms: Sequence[Atom], bindings: Bindings, premises: tuple[Triple, ...]
    ) -> Iterator[tuple[Bindings, tuple[Triple, ...]]]:
        if not atoms:
            yield bindings, premises
            return
        for fact in self.match(*_pattern(atoms[0], bindings)):
            extended = _unify(atoms[0], fact, bindings)
            if extended is not None:
                yield from self._join(atoms[1:], extended, (*premises, fact))

    def _apply(self, rule: Rule, bindings: Bindings, premises: tuple[Triple, ...]) -> None:
        if rule.head is None:
            self._conclude(rule.name, (*premises, *rule.premises), None)
            return
        s, p, o = rule.head
        head = (bindings.get(s, s), bindings.get(p, p), bindings.get(o, o))
        if head not in self.facts and not (head[1] == SAME_AS and head[0] == head[2]):
            self._conclude(rule.name, (*premises, *rule.premises), head)

    def _conclude(self, rule: str, premises: tuple[Triple, ...], head: Triple | None) -> None:
        reason = Reason(rule, tuple(dict.fromkeys(premises)))
        if head is not None:
            self._add(head, reason)
        elif self.clash is None:
            self.clash = reason


def _cells_first(triple: Triple) -> bool:
    return triple[1] not in (FIRST, REST)


def _pattern(atom: Atom, bindings: Bindings) -> Pattern:
    s, p, o = atom
    return (
        bindings.get(s) if s[0] == "?" else s,
        bindings.get(p) if p[0] == "?" else p,
        bindings.get(o) if o[0] == "?" else o,
    )


def _unify(atom: Atom, fact: Triple, bindings: Bindings) -> Bindings | None:
    found = dict(bindings)
    for word, term in zip(atom, fact, strict=True):
        if word[0] == "?":
            if found.setdefault(word, term) != term:
                return None
        elif word != term:
            return None
    return found


def _bind(rule: Rule, schema: tuple[Atom, ...], bindings: Bindings, premises: tuple[Triple, ...]) -> Rule:
    """A rule with variables replaced; `schema` are the schema atoms still to be matched."""

    def bound(word: str) -> str:
        if word[-1] == ")":
            kind, _, variable = word[:-1].partition("(")
            return f"{kind}({bindings.get(variable, variable)})"
        return bindings.get(word, word)

    def each(atom: Atom) -> Atom:
        return (bound(atom[0]), bound(atom[1]), bound(atom[2]))

    return Rule(
        rule.name,
        tuple(map(each, schema)),
        tuple(map(each, rule.data)),
        rule.head and each(rule.head),
        rule.premises + premises,
    )


def _join_order(first: Atom, others: tuple[Atom, ...]) -> tuple[Atom, ...]:
    """The atom with the most known words next."""
    known = set(first)
    left, ordered = list(others), []
    while left:
        best = max(left, key=lambda atom: sum(word[0] != "?" or word in known for word in atom))
        left.remove(best)
        ordered.append(best)
        known.update(best)
    return tuple(ordered)
