"""The map with its relations, as it follows from a snapshot and the commits since."""

from __future__ import annotations

from collections.abc import Iterable

from nodes.runtime.map_replica import MapReplica
from ontology import vocabulary as v
from schemas.commits import Commit, Star
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


class MapState(MapReplica[Commit]):
    """Besides the entities the relations asserted between individuals."""

    def __init__(self) -> None:
        super().__init__()
        self._relations: dict[Term, set[Triple]] = {}

    def relate(self, stars: Iterable[Star]) -> None:
        """Take the relations from stars. These may be newer: commits that are taken again change nothing."""
        self._relations = {}
        self._insert(triple for star in stars for triple in star.own)

    def take(self, commit: Commit) -> bool:
        """Take over a commit. False when one before it was missed, so that a snapshot is needed."""
        before = self.seq
        known = super().take(commit)
        if self.seq > before:
            for triple in commit.retracted:
                self._relations.get(triple[0], set()).discard(triple)
            self._insert(commit.inserted)
        return known

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
