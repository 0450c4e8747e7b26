"""Join plans for the data atoms of a rule: one for each atom that a new fact may match first.

A plan numbers the variables. The look-up key of an atom has constants, numbers of bound variables, or None.
Constants and bound variables need no check afterwards.
"""

from __future__ import annotations

from typing import NamedTuple

from semmap.nodes.kb_node.reasoner.explanations import Term, Triple
from semmap.nodes.kb_node.reasoner.rules.rule_table import Atom, Rule

Pattern = tuple[Term | None, Term | None, Term | None]
"""Subject, predicate, object; None is a wildcard."""
Slot = Term | int | None


class Access(NamedTuple):
    """The look-up key of an atom, and the variables that a fact binds."""

    key: tuple[Slot, Slot, Slot]
    binds: tuple[tuple[int, int], ...]
    """(variable, place in the fact)"""
    repeats: tuple[tuple[int, int], ...]
    """Places in the fact that must hold the same term."""


class Plan(NamedTuple):
    """The atoms of a rule in the order to match them, and the conclusion in numbered variables."""

    rule: Rule
    accesses: tuple[Access, ...]
    places: tuple[int, ...]
    """The position of each atom's match among the rule's premises."""
    head: tuple[Term | int, Term | int, Term | int] | None
    variables: int


def plan(rule: Rule, data: tuple[Atom, ...], first: int | None = None) -> Plan:
    """Return a plan for the data atoms of a rule, starting with atom `first`."""
    order = _join_order(data, first)
    numbers: dict[str, int] = {}
    accesses = tuple(_access(data[place], numbers) for place in order)
    head = rule.head and tuple(numbers.get(word, word) for word in rule.head)
    return Plan(rule, accesses, order, head, len(numbers))  # type: ignore[arg-type]  # the tuple keeps its length


def _join_order(atoms: tuple[Atom, ...], first: int | None) -> tuple[int, ...]:
    """Return the join order: the given atom, then always the atom with the most bound words."""
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
    binds: list[tuple[int, int]] = []
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
            binds.append((len(numbers) + len(binds), place))
    numbers.update((word, number) for word, (number, _) in zip(here, binds, strict=True))
    s, p, o = key
    return Access((s, p, o), tuple(binds), tuple(repeats))


def pattern(atom: Atom) -> Pattern:
    """Return an atom with its variables as wildcards."""
    s, p, o = (None if word[0] == "?" else word for word in atom)
    return s, p, o


def indexed(fact: Triple) -> tuple[Pattern, ...]:
    """Return the patterns under which a fact is indexed."""
    s, p, o = fact
    return (s, None, None), (None, p, None), (None, None, o), (s, p, None), (None, p, o)


def patterns(fact: Triple) -> tuple[Pattern, ...]:
    """Return all patterns that a fact matches."""
    s, p, o = fact
    return (
        (None, p, None), (None, p, o), (s, p, None), (None, None, None), (s, None, None), (None, None, o),
        (s, p, o), (s, None, o),
    )  # fmt: skip


def unify(atom: Atom, fact: Triple) -> dict[str, Term] | None:
    """Return the variable bindings of an atom for a fact; None if it does not match."""
    found: dict[str, Term] = {}
    for word, term in zip(atom, fact, strict=True):
        if word[0] == "?":
            if found.setdefault(word, term) != term:
                return None
        elif word != term:
            return None
    return found


def bind(rule: Rule, bindings: dict[str, Term], premises: tuple[Triple, ...]) -> Rule:
    """Return the rest of a rule after its first schema atom is matched."""

    def bound(word: str) -> str:
        if word[-1] == ")":
            kind, _, variable = word[:-1].partition("(")
            return f"{kind}({bindings.get(variable, variable)})"
        return bindings.get(word, word)

    def each(atom: Atom) -> Atom:
        return (bound(atom[0]), bound(atom[1]), bound(atom[2]))

    schema, data = tuple(map(each, rule.schema[1:])), tuple(map(each, rule.data))
    return Rule(rule.name, schema, data, rule.head and each(rule.head), rule.premises + premises)
