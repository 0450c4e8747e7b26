"""The relations between individuals, asserted and computed, maintained from entity triples and commits."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from semmap.ontology import vocabulary as v
from semmap.schemas.commits import Commit, PlaceChanges, Star
from semmap.schemas.entities import Entity
from semmap.schemas.explanations import Term, Triple

Relation = tuple[str, str]
"""A property and the name of the object entity."""

_DESCRIBING = {
    v.RDF_TYPE,
    v.HAS_POSITION,
    v.HAS_SIZE,
    v.HAS_PREFERRED_REFERENCE,
    v.HAS_ALTERNATIVE_REFERENCE,
}
"""Predicates that describe one entity. All others between two individuals are relations."""


def is_relation(triple: Triple) -> bool:
    """Return whether a triple relates two individuals."""
    return triple[1] not in _DESCRIBING and triple[2].startswith("<")


def missed_commits(seq: int, snapshot_seq: int, heard: Iterable[Commit]) -> list[int]:
    """Return the commits after `seq`, up to the snapshot's, that were not received."""
    return sorted(set(range(seq + 1, snapshot_seq + 1)) - {commit.seq for commit in heard})


def changed_subjects(places: PlaceChanges | None) -> list[str]:
    """Return the names of entities whose computed spatial facts changed."""
    if places is None:
        return []
    return sorted({v.entity_name(subject) for subject, _, _ in (*places.came, *places.went)})


class Relations:
    """The valid relations between individuals: asserted and not suppressed, or computed."""

    def __init__(self) -> None:
        self._asserted = _Triples()
        self._computed = _Triples()
        self._denied: set[Triple] = set()

    def begin(self, stars: Iterable[Star]) -> None:
        """Initialise the relations from entity triples.

        Commits that these already include may be applied again, in order.
        """
        stars = tuple(stars)
        self._asserted, self._computed = _Triples(), _Triples()
        self._asserted.add(triple for star in stars for triple in star.own)
        self._computed.add(triple for star in stars for triple in star.computed)
        self._denied = {triple for star in stars for triple in star.denied}

    def take(self, commit: Commit) -> None:
        """Apply a commit."""
        self._asserted.remove(commit.retracted)
        self._denied.difference_update(commit.retracted)
        self._asserted.add(commit.inserted)
        if (places := commit.places) is not None:
            self._computed.remove(places.went)
            self._computed.add(places.came)
            self._denied.difference_update(places.undenied)
            self._denied.update(places.denied)

    def between(self, entities: Mapping[str, Entity]) -> dict[str, tuple[Relation, ...]]:
        """Return the relations of each of these entities to others of them, sorted."""
        names = {v.iri(entity.iri): name for name, entity in entities.items()}
        return {
            name: tuple(sorted({(v.local_name(p), names[o]) for _, p, o in self._of(iri) if o in names}))
            for iri, name in names.items()
        }

    def _of(self, subject: Term) -> Iterator[Triple]:
        yield from (triple for triple in self._asserted.of(subject) if triple not in self._denied)
        yield from self._computed.of(subject)


class _Triples:
    """The relation triples, by subject."""

    def __init__(self) -> None:
        self._by_subject: dict[Term, set[Triple]] = {}

    def of(self, subject: Term) -> Iterable[Triple]:
        return self._by_subject.get(subject, ())

    def add(self, triples: Iterable[Triple]) -> None:
        for triple in triples:
            if is_relation(triple):
                self._by_subject.setdefault(triple[0], set()).add(triple)

    def remove(self, triples: Iterable[Triple]) -> None:
        for triple in triples:
            self._by_subject.get(triple[0], set()).discard(triple)
