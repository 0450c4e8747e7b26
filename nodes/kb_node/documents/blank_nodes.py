"""Matching of blank nodes between two graphs."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator, Mapping

from semmap.schemas.explanations import Term, Triple


def relabel_like(new: Collection[Triple], known: Collection[Triple]) -> frozenset[Triple]:
    """Return `new` with the labels of `known` for blank nodes that both describe in the same way.

    The two graphs must not share labels.
    """
    return frozenset(relabel(new, find_matches(new, known)))


def relabel(triples: Iterable[Triple], labels: Mapping[Term, Term]) -> Iterator[Triple]:
    """Yield the triples with other labels of blank nodes. Triples without these stay the same objects."""
    return (
        (labels.get(t[0], t[0]), t[1], labels.get(t[2], t[2])) if t[0] in labels or t[2] in labels else t
        for t in triples
    )


def find_matches(new: Collection[Triple], known: Collection[Triple]) -> dict[Term, Term]:
    """Return the blank nodes of `new` that `known` describes in the same way, with their labels in `known`.

    The two graphs must not share labels.
    """
    colors = _colors([*new, *known])
    free: dict[int, list[Term]] = defaultdict(list)
    for node in sorted({t for s, _, o in known for t in (s, o) if t in colors}, reverse=True):
        free[colors[node]].append(node)
    nodes = sorted({t for s, _, o in new for t in (s, o) if t in colors})
    return {node: alike.pop() for node in nodes if (alike := free[colors[node]])}


def _colors(triples: Iterable[Triple]) -> Mapping[Term, int]:
    """Return a number for each blank node; indistinguishable ones have the same (color refinement)."""
    about: dict[Term, list[Triple]] = defaultdict(list)
    for triple in triples:
        for node in filter(is_blank, {triple[0], triple[2]}):
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


def is_blank(term: Term) -> bool:
    """Return whether a term is a blank node."""
    return term.startswith("_:")
