"""The map as it follows from a snapshot and the commits since."""

from __future__ import annotations

from collections.abc import Iterable

from ontology import vocabulary as v
from schemas.commits import Commit, Snapshot, Star
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


class MapState:
    """Entities by name, and the relations asserted between individuals, after commit `seq`."""

    def __init__(self) -> None:
        self.seq = -1
        self.entities: dict[str, Entity] = {}
        self._relations: dict[Term, set[Triple]] = {}

    def begin(self, snapshot: Snapshot, stars: Iterable[Star]) -> None:
        """Take over a snapshot. The stars may be newer: the commits since, taken again, change nothing."""
        self.seq = snapshot.seq
        self.entities = {entity.name: entity for entity in snapshot.entities}
        self._relations = {}
        self._insert(triple for star in stars for triple in star.own)

    def take(self, commit: Commit) -> bool:
        """Take over a commit. False when one before it was missed, so that a snapshot is needed."""
        if commit.seq <= self.seq:
            return True
        if commit.seq != self.seq + 1:
            return False
        self.seq = commit.seq
        for gone in commit.removed:
            self.entities.pop(gone.name, None)
        self.entities.update({entity.name: entity for entity in commit.changed})
        for triple in commit.retracted:
            self._relations.get(triple[0], set()).discard(triple)
        self._insert(commit.inserted)
        return True

    def relations(self) -> dict[str, tuple[Relation, ...]]:
        """What each entity is asserted to have to do with other entities, sorted."""
        names = {v.iri(entity.iri): name for name, entity in self.entities.items()}
        return {
            name: tuple(
                sorted((v.local_name(p), names[o]) for _, p, o in self._relations.get(iri, ()) if o in names)
            )
            for iri, name in names.items()
        }

    def _insert(self, triples: Iterable[Triple]) -> None:
        for triple in triples:
            if is_relation(triple):
                self._relations.setdefault(triple[0], set()).add(triple)
