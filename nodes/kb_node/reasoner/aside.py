"""What is asserted and does not hold: triples that are set aside, found by pattern."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Set

from semmap.nodes.kb_node.reasoner.explanations import Term, Triple


class Aside:
    """A set of triples, by their subjects and by their objects; other patterns go through all."""

    def __init__(self) -> None:
        self._about: dict[Term, dict[Triple, None]] = {}
        self._of: dict[Term, dict[Triple, None]] = {}
        """By their objects."""

    def __len__(self) -> int:
        return sum(map(len, self._about.values()))

    def __bool__(self) -> bool:
        return bool(self._about)

    def __iter__(self) -> Iterator[Triple]:
        for triples in self._about.values():
            yield from triples

    def __contains__(self, triple: Triple) -> bool:
        return triple in self._about.get(triple[0], ())

    def add(self, triples: Iterable[Triple]) -> None:
        """Those that are there already stay."""
        for triple in triples:
            self._about.setdefault(triple[0], {})[triple] = None
            self._of.setdefault(triple[2], {})[triple] = None

    def remove(self, triples: Iterable[Triple]) -> None:
        """Those that are not there are passed over."""
        for triple in triples:
            for index, term in ((self._about, triple[0]), (self._of, triple[2])):
                known = index.get(term)
                if known is not None:
                    known.pop(triple, None)
                    if not known:
                        del index[term]

    def match(self, s: Term | None, p: Term | None, o: Term | None) -> Iterator[Triple]:
        """Those of a pattern; None is a wildcard."""
        triples: Iterable[Triple] = self
        if s is not None:
            triples = self._about.get(s, ())
        elif o is not None:
            triples = self._of.get(o, ())
        return (t for t in triples if (p is None or t[1] == p) and (o is None or t[2] == o))

    def mentioned(self, terms: Set[Term]) -> set[Term]:
        """Those of the terms that a triple has as its subject or object."""
        if not self._about:
            return set()
        return {term for term in terms if term in self._about or term in self._of}

    def touching(self, terms: Iterable[Term]) -> set[Triple]:
        """Those that have one of the terms as their subject or object."""
        return {t for term in terms for index in (self._about, self._of) for t in index.get(term, ())}
