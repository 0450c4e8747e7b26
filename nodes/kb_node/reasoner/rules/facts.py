"""Read-only facts with their reasons, closed under the rules."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

from msgspec import Struct, msgpack

from semmap.nodes.kb_node.reasoner.explanations import Term, Triple
from semmap.nodes.kb_node.reasoner.rules.matching import Pattern, indexed
from semmap.nodes.kb_node.reasoner.rules.rule_table import DECLARATIONS
from semmap.nodes.kb_node.reasoner.terms import FIRST, NIL, REST, SAME_AS


class Reason(NamedTuple):
    """The reason of a fact: a rule and its premises. Asserted facts have None instead."""

    rule: str
    premises: tuple[Triple, ...]


class Facts:
    """A graph and all its conclusions."""

    clash: Reason | None = None
    """The reason of the contradiction, if there is one."""

    def __init__(self, facts: dict[Triple, Reason | None]) -> None:
        """`facts` are closed under the rules, each with its reason, or None if it is asserted."""
        self.facts = facts
        self._index: dict[Pattern, dict[Triple, None]] = {}
        for fact in facts:
            self._note(fact)

    def _note(self, fact: Triple) -> None:
        for key in indexed(fact):
            self._index.setdefault(key, {})[fact] = None

    def match(self, s: Term | None = None, p: Term | None = None, o: Term | None = None) -> Iterable[Triple]:
        """Return the facts that match a pattern, in which None is a wildcard."""
        if s is not None and p is not None and o is not None:
            return ((s, p, o),) if (s, p, o) in self.facts else ()
        if s is None and p is None and o is None:
            return self.facts
        if s is not None and o is not None:
            return [fact for fact in self._index.get((s, None, None), ()) if fact[2] == o]
        return self._index.get((s, p, o), ())

    def holds(self, triple: Triple) -> bool:
        """Return whether a triple follows. Everything is the same as itself (eq-ref)."""
        s, p, o = triple
        return triple in self.facts or triple in DECLARATIONS or (p == SAME_AS and s == o)

    def leaves(self, goal: Triple | None) -> list[Triple]:
        """Return the asserted triples behind a fact (None: the clash), in the order of the proof."""
        seen: set[Triple | None] = set()
        leaves: list[Triple] = []
        pending = [goal]
        while pending:
            fact = pending.pop()
            if fact in seen:
                continue
            seen.add(fact)
            reason = self.reason(fact)
            if reason is not None:
                pending += reversed(reason.premises)
            elif fact is not None and fact in self.facts:
                leaves.append(fact)
        return leaves

    def reason(self, fact: Triple | None) -> Reason | None:
        """Return the reason of a fact (None: the clash); None if it is asserted or absent."""
        return self.clash if fact is None else self.facts.get(fact)

    def members(self, head: Term) -> tuple[list[Term], tuple[Triple, ...]] | None:
        """Return members and cells of an asserted list; None if it is incomplete, branching or cyclic."""
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


class _Packed(Struct, array_like=True):
    """Facts as numbers: positions in `terms` and `facts`."""

    terms: list[Term]
    facts: list[tuple[int, int, int]]
    rules: list[str]
    """The rule of each fact; empty for asserted facts."""
    premises: list[list[int]]


def pack(facts: Facts) -> bytes:
    """Serialise consistent facts for `unpack`."""
    terms = {term: i for i, term in enumerate(dict.fromkeys(term for fact in facts.facts for term in fact))}
    places = {fact: i for i, fact in enumerate(facts.facts)}
    return msgpack.encode(
        _Packed(
            terms=list(terms),
            facts=[(terms[s], terms[p], terms[o]) for s, p, o in places],
            rules=["" if reason is None else reason.rule for reason in facts.facts.values()],
            premises=[
                [] if reason is None else [places[fact] for fact in reason.premises]
                for reason in facts.facts.values()
            ],
        )
    )


def unpack(content: bytes) -> Facts:
    """Return the facts that were serialised by `pack`."""
    packed = msgpack.decode(content, type=_Packed)
    terms = packed.terms
    facts = [(terms[s], terms[p], terms[o]) for s, p, o in packed.facts]
    reasons = (
        Reason(rule, tuple([facts[premise] for premise in premises])) if rule else None
        for rule, premises in zip(packed.rules, packed.premises, strict=True)
    )
    return Facts(dict(zip(facts, reasons, strict=True)))
