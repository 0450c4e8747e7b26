"""Matching of blank nodes between two graphs."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Iterable, Mapping

from semmap.schemas.explanations import Term, Triple


def relabel_like(new: Collection[Triple], known: Collection[Triple]) -> frozenset[Triple]:
    """Return `new` with the labels of `known` for blank nodes that both describe in the same way.

    The two graphs must not share labels.
    """
    colors = _colors([*new, *known])
    free: dict[int, list[Term]] = defaultdict(list)
    for node in sorted({t for s, _, o in known for t in (s, o) if t in colors}, reverse=True):
        free[colors[node]].append(node)
    nodes = sorted({t for s, _, o in new for t in (s, o) if t in colors})
    labels = {node: alike.pop() for node in nodes if (alike := free[colors[node]])}
    return frozenset((labels.get(s, s), p, labels.get(o, o)) for s, p, o in new)


def _colors(triples: Iterable[Triple]) -> Mapping[Term, int]:
    """Return a number for each blank node; indistinguishable ones have the same (color refinement)."""
    about: dict[Term, list[Triple]] = defaultdict(list)
    for triple in triples:
        for node in filter(_is_blank, {triple[0], triple[2]}):
            about[node].append(triple)
    colors = dict.fromkeys(about, 0)
    count = 0
    while count < (count := len(set(colors.values()))):  # the last round distinguished more of them
        numbers: dict[object, int] = {}
        colors = {
            node: numbers.setdefault((colors[node], *_seen_from(node, triples_about, colors)), len(numbers))
            for node, triples_about in about.items()
        }
    return colors


def _seen_from(node: Term, triples_about: Iterable[Triple], colors: Mapping[Term, int]) -> list[Triple]:
    """Return the triples about a blank node, with colors in place of other labels."""

    def name(term: Term) -> str:
        if term == node:
            return "_:"
        return f"_:{colors[term]}" if term in colors else term

    return sorted((name(s), p, name(o)) for s, p, o in triples_about)


def _is_blank(term: Term) -> bool:
    return term.startswith("_:")
