"""The relations between individuals, as they follow from stars and the commits since."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from ontology import vocabulary as v
from schemas.commits import Commit, Star
from schemas.entities import Entity
from schemas.explanations import Term, Triple

Relation = tuple[str, str]
"""A property and the name of the entity that it leads to."""

_OF_THE_STAR = {
    v.RDF_TYPE,
    v.HAS_POSITION,
    v.HAS_SIZE,
    v.HAS_PREFERRED_REFERENCE,
    v.HAS_ALTERNATIVE_REFERENCE,
}
"""Predicates that describe one entity; all others between two individuals are relations."""


def is_relation(triple: Triple) -> bool:
    """Whether a triple relates one individual to another, rather than describing it."""
    return triple[1] not in _OF_THE_STAR and triple[2].startswith("<")


def missed(seq: int, snapshot_seq: int, heard: Iterable[Commit]) -> list[int]:
    """The commits after `seq`, up to a snapshot's, that were not heard."""
    return sorted(set(range(seq + 1, snapshot_seq + 1)) - {commit.seq for commit in heard})


class Relations:
    """The relations that are asserted between individuals, as they follow from stars and later commits."""

    def __init__(self) -> None:
        self._by_subject: dict[Term, set[Triple]] = {}

    def begin(self, stars: Iterable[Star]) -> None:
        """Take the relations from stars; commits that these know already may be taken again, in order."""
        self._by_subject = {}
        self._insert(triple for star in stars for triple in star.own)

    def take(self, commit: Commit) -> None:
        """Take over a commit."""
        for triple in commit.retracted:
            self._by_subject.get(triple[0], set()).discard(triple)
        self._insert(commit.inserted)

    def between(self, entities: Mapping[str, Entity]) -> dict[str, tuple[Relation, ...]]:
        """What each of these entities is asserted to have to do with others of them, sorted."""
        names = {v.iri(entity.iri): name for name, entity in entities.items()}
        return {
            name: tuple(
                sorted((v.local_name(p), names[o]) for _, p, o in self._by_subject.get(iri, ()) if o in names)
            )
            for iri, name in names.items()
        }

    def _insert(self, triples: Iterable[Triple]) -> None:
        for triple in triples:
            if is_relation(triple):
                self._by_subject.setdefault(triple[0], set()).add(triple)
