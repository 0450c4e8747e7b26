"""The state of the map after the last commit, and the queries on it."""

from __future__ import annotations

import os
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from typing import TypeVar

from msgspec import structs

from semmap.nodes.kb_node.derived_facts import DerivedChanges, DerivedFacts
from semmap.nodes.kb_node.entities import entity_changes, entity_reading, equal_individuals, new_entities
from semmap.nodes.kb_node.entities.class_table import ClassTable
from semmap.nodes.kb_node.individuals import Individuals
from semmap.nodes.kb_node.places import Places
from semmap.nodes.kb_node.progress import split_batches, with_progress
from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.nodes.kb_node.relations.facts.place_facts import Facts
from semmap.nodes.kb_node.relations.facts.precomputation import Precomputation
from semmap.nodes.kb_node.relations.facts.precompute_messages import PrecomputeRequest
from semmap.nodes.kb_node.relations.geometry.placed_entity import PlacedEntity, model_of
from semmap.nodes.kb_node.relations.selection import resolve_single
from semmap.nodes.runtime import memory
from semmap.nodes.runtime.map_replica import note_name
from semmap.ontology import vocabulary as v
from semmap.ontology.model_shapes import WorldShapes, added_shapes, exchange_world, world
from semmap.schemas import errors
from semmap.schemas.commits import Commit, Snapshot, Star, Transaction
from semmap.schemas.entities import ClassInfo, Entity
from semmap.schemas.explanations import Term, Triple

T = TypeVar("T")

_STEP = 2000
"""Entities whose classes are compared in some milliseconds."""
_HAS_CORES = (os.cpu_count() or 1) > 1


class MapState:
    """The TBox, the asserted and computed facts, and the entities that they describe. Owned by one thread."""

    def __init__(self, tbox: frozenset[Triple], reasoner: Reasoner, progress: Callable[[], None]) -> None:
        """Create a map that contains only its TBox, which `reasoner` holds.

        `progress` is called between the steps of long work.
        """
        self.progress = progress
        self.individuals = Individuals(self)
        """The individuals that are not in space."""
        self.exchange_tbox(tbox, reasoner)
        self._derivation: Iterator[None] | None = None
        self.derives_at_commits = False
        """Whether facts are derived from poses at each commit. It is False right after a start."""
        self._derived_all = False
        """Whether the facts of all entities are derived. If not, a commit derives those that it concerns."""
        self.has_derived = False
        """Whether the reasoner holds the computed facts. After a start it does if its columns were stored."""
        self.by_name: dict[str, Entity] = {}
        """The entities. Only `apply_commit`, `revert_entities` and `update_entities` change them."""
        self.places = Places(
            self.by_name,
            self.entities,
            lambda p: self.reasoner.asserted(None, p, None),
            lambda: self.classes.limits,
            self._facts,
            self._crowds,
        )
        self.seq = 0
        self.digest = ""
        """The digest of the last commit, and so of the whole history, in hexadecimal. Empty before the first
        commit."""

    # Queries

    def __len__(self) -> int:
        return len(self.by_name)

    def entity(self, name: str) -> Entity:
        """Return the entity of that name. Raises UnknownName with the most similar names."""
        if name in self.by_name:
            return self.by_name[name]
        raise errors.UnknownName(
            f"no entity is named '{name}'{errors.suggestion(name, self.by_name, 'list')}"
        )

    def resolve(self, word: str) -> Entity:
        """Return the entity of that name, or the only one with that label or class.

        Raises UnknownName; BadRequest if the word refers to several.
        """
        if word in self.by_name:
            return self.by_name[word]
        return self.by_name[resolve_single(tuple(self.entities()), word)]

    def described(self, word: str) -> Entity:
        """Return the entity, or the individual that is not in space, with this name or IRI.

        Raises UnknownName; BadRequest for a name of several individuals.
        """
        if word in self.by_name:
            return self.by_name[word]
        iri = self.individuals.parse_iri(word)
        entity = None if iri is None else self.find_by_individual(iri)
        return entity or self.individuals.find(word) or self.entity(word)

    def find(self, name: str) -> Entity | None:
        """Return the entity of that name, or None."""
        return self.by_name.get(name)

    @property
    def names(self) -> Collection[str]:
        """The names of the entities."""
        return self.by_name.keys()

    def entities(self, class_iri: Term | None = None) -> Iterator[Entity]:
        """Yield the entities in the order of their names, or those of a class, including inferred ones."""
        if class_iri is None:
            return (self.by_name[name] for name in sorted(self.by_name))
        self.ensure_derived()
        found = filter(None, map(self.find_by_iri, self.reasoner.instances(class_iri)))
        return iter(sorted(found, key=lambda entity: entity.name))

    def snapshot(self) -> Snapshot:
        """Return all entities as of the last commit."""
        return Snapshot(seq=self.seq, entities=tuple(self.entities()), digest=self.digest)

    def stars(self, names: Iterable[str]) -> tuple[Star, ...]:
        """Return the triples about some entities, taken together.

        Raises UnknownName; Refused for entities of the TBox.
        """
        self.ensure_derived()
        iris = [v.iri(self.entity(name).iri) for name in names]
        leaving = frozenset(equal_individuals.with_equals(self.reasoner, iris))
        return tuple(
            entity_reading.read_entity_triples(self.reasoner, self.classes, iri, self.seq, leaving, self.tbox)
            for iri in iris
        )

    def class_table(self) -> Iterator[ClassInfo]:
        """Yield the classes with the number of their asserted and inferred entities."""
        return self.classes.with_counts(self.by_name.values())

    def abox(self) -> list[Triple]:
        """Return the asserted triples that are not part of the TBox."""
        tbox = self.tbox
        return [t for triples in self.reasoner.by_subject() for t in triples if t not in tbox]

    def inferred(self, name: str | None = None) -> Iterator[Triple]:
        """Yield the inferred triples about one entity, or about all. Raises UnknownName."""
        self.ensure_derived()
        for entity in [self.entity(name)] if name is not None else self.entities():
            yield from sorted(self.reasoner.inferred(v.iri(entity.iri), None, None))

    def with_progress(self, items: Iterable[T]) -> Iterator[T]:
        """Yield the items and send heartbeats in between."""
        return with_progress(items, self.progress)

    def all_derived(self) -> DerivedChanges:
        """Return all computed and all suppressed facts."""
        self.ensure_derived()
        return self.derived_facts.all()

    def placed(self) -> tuple[PlacedEntity, ...]:
        """Return the poses and shapes of all entities."""
        return tuple(map(PlacedEntity.of, self.by_name.values()))

    def is_asserted(self, triple: Triple) -> bool:
        """Return whether a triple is asserted."""
        return any(self.reasoner.asserted(*triple))

    def types_of(self, entity: Entity) -> tuple[str, ...]:
        """Return the current classes of an entity, including those that follow from computed facts."""
        return self.classes.type_names(self.reasoner.types(v.iri(entity.iri)))

    def find_by_iri(self, iri: Term) -> Entity | None:
        """Return the entity with this IRI as of the last commit."""
        return entity_changes.known(self.by_name, iri)

    def find_by_individual(self, iri: Term) -> Entity | None:
        """Return the entity that an individual is, also by an IRI that is not that of the entity."""
        found = (self.find_by_iri(one) for one in self.reasoner.equals(iri) or (iri,))
        return next(filter(None, found), None)

    # Facts that are computed from poses

    def derive_all(self) -> None:
        """Derive the facts of all entities from their poses, unless that is already done.

        The first commit after a start and queries for inferred facts need it.
        """
        while self.derive_some():
            self.progress()

    def derive_for(self, transaction: Transaction) -> None:
        """Derive as many facts as a transaction needs.

        A transaction that only places entities needs no more than the poses of all entities, if no locations
        are asserted. The remaining facts are derived between other work.
        """
        while not self._derived_all and not (self.derives_at_commits and _only_places(transaction)):
            self.derive_some()
            self.progress()

    def derive_some(self) -> bool:
        """Derive facts for some tens of milliseconds. Return whether there is more to do."""
        if self._derived_all:
            return False
        following, self._derivation = self._derivation or self._derivation_steps(), None
        with memory.uncollected(freeze=True):
            for _ in following:
                self._derivation = following
                return True
        return False

    def _derivation_steps(self) -> Iterator[None]:
        self.derived_facts.begin()
        yield from self.derived_facts.placing(self.by_name)
        self.derives_at_commits = self.has_derived and self.derived_facts.is_compared_in_steps()
        yield from self.derived_facts.comparing(self.by_name)
        self.derives_at_commits = self.has_derived = self._derived_all = True
        for names in split_batches(tuple(self.by_name), _STEP, self.progress):
            for name in names:
                entity = self.by_name.get(name)
                if entity is not None and (types := self.types_of(entity)) != entity.types:
                    self.by_name[name] = structs.replace(entity, types=types)
            yield

    def ensure_derived(self) -> None:
        """Make sure that the reasoner holds the computed facts."""
        if not self.has_derived:
            self.derive_all()

    def _crowds(self, names: Collection[str] | None) -> list[str]:
        """Return the notes on crowds, if relations are computed."""
        if not self.derives_at_commits or names is None:
            self.derive_all()
        return (
            []
            if self.derived_facts.computed.is_idle
            else self.derived_facts.computed.facts.space.describe_crowds(names)
        )

    def _facts(self) -> Facts | None:
        """Return the computed relations with their solids, or None if none are computed."""
        self.derive_all()
        return None if self.derived_facts.computed.is_idle else self.derived_facts.computed.facts

    @contextmanager
    def predicted_places(self, transaction: Transaction) -> Iterator[None]:
        """Within this context, a separate process computes the relations after a large transaction."""
        computed = self.derived_facts.computed
        if _HAS_CORES and not computed.is_idle:
            self._predict_places(transaction)
        try:
            yield
        finally:
            computed.facts.discard_precomputation()

    def _predict_places(self, transaction: Transaction) -> None:
        coming, facts = (
            new_entities.predict_new_entities(transaction, self.classes),
            self.derived_facts.computed.facts,
        )
        if coming is not None and len(self) <= len(coming):
            foreseen = PrecomputeRequest(facts.space.limits, self.placed(), coming, added_shapes())
            with suppress(OSError):  # then they are computed in this process
                facts.set_precomputation(Precomputation(foreseen, self.progress))

    def exchange_shapes(self, shapes: WorldShapes) -> frozenset[str]:
        """Replace the shapes of the bodies of world files, and compute the relations of their entities again.

        Return the names of the entities whose shapes or relations have changed. There is no commit, because
        nothing that is asserted changes.
        """
        names = {**world().bodies, **shapes.bodies}
        bodies = [entity for name in names if (entity := self.by_name.get(name)) is not None]
        if bodies:
            self.derive_all()
        before = list(map(model_of, bodies))
        exchange_world(shapes)
        changed = {e.name: e for e, model in zip(bodies, before, strict=True) if model_of(e) != model}
        if not changed:
            return frozenset()
        facts = self.derived_facts
        facts.begin()  # they are taken out of the facts, and inserted again
        facts.follow((), changed, self.by_name.get, (), ())
        moved = facts.follow(
            changed.values(), (), lambda name: None if name in changed else self.by_name.get(name), (), ()
        )
        for entity in list(filter(None, map(self.find_by_iri, moved))):
            self.by_name[entity.name] = structs.replace(entity, types=self.types_of(entity))
        return frozenset((*changed, *facts.derived_changes.subjects))

    def clean_up(self) -> None:
        """Do the cleanup that a commit leaves for a time when no client waits."""
        self.derived_facts.computed.facts.clear_caches()

    # Changes

    def exchange_tbox(self, tbox: frozenset[Triple], reasoner: Reasoner) -> None:
        """Replace the TBox. `reasoner` holds it and nothing else."""
        self.tbox, self.reasoner = tbox, reasoner
        self.classes = ClassTable(reasoner)
        self.derived_facts = DerivedFacts(reasoner, self.classes.limits, self.progress)

    def apply_commit(self, commit: Commit) -> None:
        """Update the entities for a commit that the reasoner has already applied."""
        self.seq, self.digest = commit.seq, commit.digest
        self.individuals.note(commit)
        self.places.update(commit.names, commit.retracted, commit.inserted)
        for removed in commit.removed:
            del self.by_name[removed.name]
        self.update_entities(commit.changed)

    def revert_entities(self, commit: Commit, before: Mapping[str, Entity | None], digest: str) -> None:
        """Restore the entities from before the last commit. None stands for an entity that did not exist.

        `digest` is the digest of the commit before.
        """
        self.seq, self.digest = commit.seq - 1, digest
        self.individuals.note(commit)
        self.places.update(commit.names, commit.inserted, commit.retracted)
        for name, entity in before.items():
            if entity is None:
                self.by_name.pop(name, None)
            else:
                self.by_name[name] = entity

    def update_entities(self, changed: Iterable[Entity]) -> None:
        """Replace entities by name."""
        for entity in changed:
            self.by_name[entity.name] = entity
            note_name(entity)


def _only_places(transaction: Transaction) -> bool:
    """Return whether a transaction only adds entities and changes poses, sizes and labels."""
    if transaction.remove or transaction.require or transaction.retract or transaction.insert:
        return False
    if transaction.others:
        return False
    return not (
        any(edit.carry or edit.set or edit.unset or edit.only_if for edit in transaction.edit)
        or any(new.set for new in transaction.add)
    )
