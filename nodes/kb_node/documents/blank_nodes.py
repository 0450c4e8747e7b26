"""Blank nodes: their depth in class expressions, and matching of those of two graphs."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator, Mapping

from semmap.ontology import vocabulary as v
from semmap.schemas.explanations import Term, Triple
from semmap.schemas.nesting import LIMIT

_INNER = frozenset(
    {
        *(
            v.iri(v.OWL + name)
            for name in ("complementOf", "datatypeComplementOf", "unionOf", "intersectionOf")
        ),
        *(v.iri(v.OWL + name) for name in ("someValuesFrom", "allValuesFrom", "onClass", "onDataRange")),
        *(v.iri(v.OWL + name) for name in ("onProperty", "inverseOf", "withRestrictions", "disjointUnionOf")),
        v.RDF_FIRST,
    }
)
"""The properties whose value is an inner part of an expression."""
_ROUNDS = 20
"""Rounds after which blank nodes count as indistinguishable, which only makes the matching less exact.

A chain of many equal blank nodes would take as many rounds as it has nodes.
"""


def require_shallow_expressions(triples: Iterable[Triple]) -> None:
    """Raise ValueError if class expressions are nested deeper than `LIMIT` levels, or contain themselves.

    The length of a list does not count.
    """
    edges = [(s, o) for s, p, o in triples if o[0] == "_" and s[0] == "_" and p in _INNER]
    if len(edges) <= LIMIT:
        return
    below: dict[Term, list[Term]] = defaultdict(list)
    above = dict.fromkeys((node for edge in edges for node in edge), 0)
    for s, o in edges:
        below[s].append(o)
        above[o] += 1
    level, depth, seen = [node for node, count in above.items() if not count], 0, 0
    while level:
        if depth > LIMIT:
            raise ValueError(f"class expressions are nested deeper than {LIMIT} levels")
        depth, seen, deeper = depth + 1, seen + len(level), list[Term]()
        for node in level:
            for inner in below.get(node, ()):
                above[inner] -= 1
                if not above[inner]:
                    deeper.append(inner)
        level = deeper
    if len(above) - seen > LIMIT:
        raise ValueError("class expressions contain themselves")


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
    for _ in range(_ROUNDS):
        if count == (count := len(set(colors.values()))):  # the last round distinguished no more of them
            break
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
