"""Suppressed facts: asserted triples that do not hold."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Set

from semmap.nodes.kb_node.reasoner.explanations import Term, Triple


class SuppressedFacts:
    """A set of triples with an index by subject and one by object. Other patterns scan all triples."""

    def __init__(self) -> None:
        self._by_subject: dict[Term, dict[Triple, None]] = {}
        self._by_object: dict[Term, dict[Triple, None]] = {}

    def __len__(self) -> int:
        return sum(map(len, self._by_subject.values()))

    def __bool__(self) -> bool:
        return bool(self._by_subject)

    def __iter__(self) -> Iterator[Triple]:
        for triples in self._by_subject.values():
            yield from triples

    def __contains__(self, triple: Triple) -> bool:
        return triple in self._by_subject.get(triple[0], ())

    def add(self, triples: Iterable[Triple]) -> None:
        """Add triples. Triples that are already in the set are kept."""
        for triple in triples:
            self._by_subject.setdefault(triple[0], {})[triple] = None
            self._by_object.setdefault(triple[2], {})[triple] = None

    def remove(self, triples: Iterable[Triple]) -> None:
        """Remove triples. Triples that are not in the set are ignored."""
        for triple in triples:
            for index, term in ((self._by_subject, triple[0]), (self._by_object, triple[2])):
                known = index.get(term)
                if known is not None:
                    known.pop(triple, None)
                    if not known:
                        del index[term]

    def match(self, s: Term | None, p: Term | None, o: Term | None) -> Iterator[Triple]:
        """Return the triples that match a pattern, in which None is a wildcard."""
        triples: Iterable[Triple] = self
        if s is not None:
            triples = self._by_subject.get(s, ())
        elif o is not None:
            triples = self._by_object.get(o, ())
        return (t for t in triples if (p is None or t[1] == p) and (o is None or t[2] == o))

    def mentioned(self, terms: Set[Term]) -> set[Term]:
        """Return those of `terms` that are the subject or object of a triple."""
        if not self._by_subject:
            return set()
        return {term for term in terms if term in self._by_subject or term in self._by_object}

    def about(self, terms: Iterable[Term]) -> set[Triple]:
        """Return the triples whose subject or object is one of `terms`."""
        return {
            t for term in terms for index in (self._by_subject, self._by_object) for t in index.get(term, ())
        }
