"""Triples put in the order in which they are read quickest: star by star, those that are alike together."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from itertools import chain

from semmap.nodes.kb_node.reasoner.explanations import Term, Triple
from semmap.nodes.kb_node.reasoner.terms import TYPE, is_literal


def order_by_entity(triples: Iterable[Triple]) -> list[Triple]:
    """The same triples: an individual with all that is said of it, then those that only it refers to.

    Whoever several refer to comes before them, so that it is known by then.
    """
    said: dict[Term, list[Triple]] = {}
    for triple in triples:
        if (told := said.get(triple[0])) is None:
            said[triple[0]] = [triple]
        else:
            told.append(triple)
    for told in said.values():
        told.sort(key=_place)
    counted = Counter([o for told in said.values() for _, p, o in told if p != TYPE and o in said])
    found: list[Triple] = []
    for wanted in (lambda count: count > 1, lambda count: count == 0, lambda count: True):
        heads: dict[tuple[Term, ...], list[Term]] = {}
        for subject in said:
            if wanted(counted[subject]):
                heads.setdefault(_beginning(said[subject]), []).append(subject)
        for subject in chain.from_iterable(heads.values()):
            for star in _entity_triples(subject, said, counted):
                found += star
    return found


def _beginning(told: list[Triple]) -> tuple[Term, ...]:
    """What is the same in what is said of individuals that are likely to be alike."""
    return (told[0][2], *(p for _, p, _ in told))


def _entity_triples(
    subject: Term, said: dict[Term, list[Triple]], counted: Counter[Term]
) -> Iterator[list[Triple]]:
    """What is said of an individual and of those that only it refers to; it is taken out of `said`."""
    pending = [subject]
    while pending:
        told = said.pop(pending.pop(), None)
        if told is not None:
            yield told
            pending += [
                o for _, p, o in reversed(told) if counted[o] == 1 and p != TYPE and not is_literal(o)
            ]


def _place(triple: Triple) -> tuple[bool, Term]:
    return triple[1] != TYPE, triple[1]
