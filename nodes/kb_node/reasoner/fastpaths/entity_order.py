"""Ordering of triples for fast loading: grouped by entity, entities of the same form together."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from itertools import chain

from semmap.nodes.kb_node.reasoner.explanations import Term, Triple
from semmap.nodes.kb_node.reasoner.terms import TYPE, is_literal


def order_by_entity(triples: Iterable[Triple]) -> list[Triple]:
    """Order triples by entity: an individual with all its triples, then those that only it refers to.

    An individual that several others refer to comes before them.
    """
    described: dict[Term, list[Triple]] = {}
    for triple in triples:
        if (own := described.get(triple[0])) is None:
            described[triple[0]] = [triple]
        else:
            own.append(triple)
    for own in described.values():
        own.sort(key=_sort_key)
    counted = Counter([o for own in described.values() for _, p, o in own if p != TYPE and o in described])
    found: list[Triple] = []
    for wanted in (lambda count: count > 1, lambda count: count == 0, lambda count: True):
        heads: dict[tuple[Term, ...], list[Term]] = {}
        for subject in described:
            if wanted(counted[subject]):
                heads.setdefault(_form_key(described[subject]), []).append(subject)
        for subject in chain.from_iterable(heads.values()):
            for own in _entity_triples(subject, described, counted):
                found += own
    return found


def _form_key(own: list[Triple]) -> tuple[Term, ...]:
    """Return a key that individuals of the same form are likely to share."""
    return (own[0][2], *(p for _, p, _ in own))


def _entity_triples(
    subject: Term, described: dict[Term, list[Triple]], counted: Counter[Term]
) -> Iterator[list[Triple]]:
    """Remove from `described` and yield the triples of an individual and of those that only it refers to."""
    pending = [subject]
    while pending:
        own = described.pop(pending.pop(), None)
        if own is not None:
            yield own
            pending += [o for _, p, o in reversed(own) if counted[o] == 1 and p != TYPE and not is_literal(o)]


def _sort_key(triple: Triple) -> tuple[bool, Term]:
    return triple[1] != TYPE, triple[1]
