"""How a rule's data atoms are matched: planned once for each atom that a new fact may match first.

A plan numbers the variables. What an atom is looked up by is a constant, the number of a variable that is
known by then, or None; constants and known variables need no check afterwards.
"""

from __future__ import annotations

from typing import NamedTuple

from semmap.nodes.kb_node.reasoner.explanations import Term, Triple
from semmap.nodes.kb_node.reasoner.rules.rule_table import Atom, Rule

Pattern = tuple[Term | None, Term | None, Term | None]
"""Subject, predicate, object; None is a wildcard."""
Slot = Term | int | None


class Access(NamedTuple):
    """One atom: what to look facts up by, and which variables a fact then settles."""

    key: tuple[Slot, Slot, Slot]
    takes: tuple[tuple[int, int], ...]
    """(variable, place in the fact)"""
    repeats: tuple[tuple[int, int], ...]
    """Places in the fact that must hold the same term."""


class Plan(NamedTuple):
    """The atoms of a rule in the order to match them, and the conclusion in numbered variables."""

    rule: Rule
    accesses: tuple[Access, ...]
    places: tuple[int, ...]
    """Where the match of each atom stands among the rule's premises."""
    head: tuple[Term | int, Term | int, Term | int] | None
    variables: int


def plan(rule: Rule, data: tuple[Atom, ...], first: int | None = None) -> Plan:
    """Plan to match the data atoms of a rule, beginning with the given one."""
    order = _join_order(data, first)
    numbers: dict[str, int] = {}
    accesses = tuple(_access(data[place], numbers) for place in order)
    head = rule.head and tuple(numbers.get(word, word) for word in rule.head)
    return Plan(rule, accesses, order, head, len(numbers))  # type: ignore[arg-type]  # three words stay three


def _join_order(atoms: tuple[Atom, ...], first: int | None) -> tuple[int, ...]:
    """The given atom first, then always the one with the most known words."""
    left = [place for place in range(len(atoms)) if place != first]
    order = [] if first is None else [first]
    while left:
        known = {word for place in order for word in atoms[place]}
        best = max(left, key=lambda place: sum(word[0] != "?" or word in known for word in atoms[place]))
        left.remove(best)
        order.append(best)
    return tuple(order)


def _access(atom: Atom, numbers: dict[str, int]) -> Access:
    key: list[Slot] = []
    takes: list[tuple[int, int]] = []
    repeats: list[tuple[int, int]] = []
    here: dict[str, int] = {}
    for place, word in enumerate(atom):
        if word[0] != "?":
            key.append(word)
        elif word in here:
            key.append(None)
            repeats.append((here[word], place))
        elif word in numbers:
            key.append(numbers[word])
        else:
            key.append(None)
            here[word] = place
            takes.append((len(numbers) + len(takes), place))
    numbers.update((word, number) for word, (number, _) in zip(here, takes, strict=True))
    s, p, o = key
    return Access((s, p, o), tuple(takes), tuple(repeats))


def pattern(atom: Atom) -> Pattern:
    """An atom with its variables as wildcards."""
    s, p, o = (None if word[0] == "?" else word for word in atom)
    return s, p, o


def indexed(fact: Triple) -> tuple[Pattern, ...]:
    """The patterns that facts are looked up by."""
    s, p, o = fact
    return (s, None, None), (None, p, None), (None, None, o), (s, p, None), (None, p, o)


def patterns(fact: Triple) -> tuple[Pattern, ...]:
    """All patterns that a fact matches."""
    s, p, o = fact
    return (
        (None, p, None), (None, p, o), (s, p, None), (None, None, None), (s, None, None), (None, None, o),
        (s, p, o), (s, None, o),
    )  # fmt: skip


def unify(atom: Atom, fact: Triple) -> dict[str, Term] | None:
    """The variables of an atom as a fact has them; None when it does not match."""
    found: dict[str, Term] = {}
    for word, term in zip(atom, fact, strict=True):
        if word[0] == "?":
            if found.setdefault(word, term) != term:
                return None
        elif word != term:
            return None
    return found


def bind(rule: Rule, bindings: dict[str, Term], premises: tuple[Triple, ...]) -> Rule:
    """What is left of a rule when its first schema atom is matched."""

    def bound(word: str) -> str:
        if word[-1] == ")":
            kind, _, variable = word[:-1].partition("(")
            return f"{kind}({bindings.get(variable, variable)})"
        return bindings.get(word, word)

    def each(atom: Atom) -> Atom:
        return (bound(atom[0]), bound(atom[1]), bound(atom[2]))

    schema, data = tuple(map(each, rule.schema[1:])), tuple(map(each, rule.data))
    return Rule(rule.name, schema, data, rule.head and each(rule.head), rule.premises + premises)
