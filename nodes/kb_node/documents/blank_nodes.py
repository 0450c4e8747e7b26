"""Blank nodes have no names: which of two graphs stand for the same?"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Iterable, Mapping

from semmap.schemas.explanations import Term, Triple


def relabel_like(new: Collection[Triple], known: Collection[Triple]) -> frozenset[Triple]:
    """`new`, where a blank node of which it says what `known` says of one has that one's label.

    The two have no label in common.
    """
    colors = _colors([*new, *known])
    free: dict[int, list[Term]] = defaultdict(list)
    for node in sorted({t for s, _, o in known for t in (s, o) if t in colors}, reverse=True):
        free[colors[node]].append(node)
    nodes = sorted({t for s, _, o in new for t in (s, o) if t in colors})
    labels = {node: alike.pop() for node in nodes if (alike := free[colors[node]])}
    return frozenset((labels.get(s, s), p, labels.get(o, o)) for s, p, o in new)


def _colors(triples: Iterable[Triple]) -> Mapping[Term, int]:
    """A number for each blank node; those that nothing tells apart have the same (color refinement)."""
    about: dict[Term, list[Triple]] = defaultdict(list)
    for triple in triples:
        for node in filter(_is_blank, {triple[0], triple[2]}):
            about[node].append(triple)
    colors = dict.fromkeys(about, 0)
    count = 0
    while count < (count := len(set(colors.values()))):  # the last round told more of them apart
        numbers: dict[object, int] = {}
        colors = {
            node: numbers.setdefault((colors[node], *_seen_from(node, said, colors)), len(numbers))
            for node, said in about.items()
        }
    return colors


def _seen_from(node: Term, said: Iterable[Triple], colors: Mapping[Term, int]) -> list[Triple]:
    """What is said of a blank node, with colors for the others' labels."""

    def name(term: Term) -> str:
        if term == node:
            return "_:"
        return f"_:{colors[term]}" if term in colors else term

    return sorted((name(s), p, name(o)) for s, p, o in said)


def _is_blank(term: Term) -> bool:
    return term.startswith("_:")
