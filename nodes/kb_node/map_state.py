"""What the map says as of its last commit, and everything that can be asked of it."""

from __future__ import annotations

import os
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from typing import TypeVar

from msgspec import structs

from semmap.nodes.kb_node.derived_facts import DerivedChanges, DerivedFacts
from semmap.nodes.kb_node.entities import entity_changes, entity_reading, new_entities
from semmap.nodes.kb_node.entities.class_table import ClassTable
from semmap.nodes.kb_node.places import Places
from semmap.nodes.kb_node.progress import split_batches, with_progress
from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.nodes.kb_node.relations.facts.ahead import Ahead
from semmap.nodes.kb_node.relations.facts.foreseen import Foreseen
from semmap.nodes.kb_node.relations.facts.place_facts import Facts
from semmap.nodes.kb_node.relations.geometry.placed import Placed
from semmap.nodes.runtime import gc_pause
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.commits import Commit, Snapshot, Star, Transaction
from semmap.schemas.entities import ClassInfo, Entity
from semmap.schemas.explanations import Term, Triple

T = TypeVar("T")

_STEP = 2000
"""Entities whose classes are compared in some milliseconds."""
_HAS_CORES = (os.cpu_count() or 1) > 1


class MapState:
    """The TBox, what is asserted and computed, and the entities that these make. Owned by one thread."""

    def __init__(self, tbox: frozenset[Triple], reasoner: Reasoner, progress: Callable[[], None]) -> None:
        """A map of nothing but its TBox, which `reasoner` holds.

        `progress` is called between the steps of long work.
        """
        self.progress = progress
        self.exchange_tbox(tbox, reasoner)
        self._derivation: Iterator[None] | None = None
        self.derives_at_commits = False
        """Whether what is computed is worked out at each commit; not yet after a start."""
        self._derived_all = False
        """Whether all of it was; if not, a commit works out what it concerns."""
        self.has_derived = False
        """Whether the reasoner has what is computed; after a start it does if its columns were kept."""
        self.by_name: dict[str, Entity] = {}
        """The entities; changed by `apply_commit` and `revert_entities` only."""
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
        """That of the last commit, and so of the whole history, in hexadecimal; empty before the first."""

    # Asking

    def __len__(self) -> int:
        return len(self.by_name)

    def entity(self, name: str) -> Entity:
        """The entity of that name. Raises UnknownName with the nearest ones."""
        if name in self.by_name:
            return self.by_name[name]
        raise errors.UnknownName(f"no entity is named '{name}'{errors.did_you_mean(name, self.by_name)}")

    def find(self, name: str) -> Entity | None:
        """The entity of that name, if there is one."""
        return self.by_name.get(name)

    @property
    def names(self) -> Collection[str]:
        """Those of the entities."""
        return self.by_name.keys()

    def entities(self, class_iri: Term | None = None) -> Iterator[Entity]:
        """The entities, or those of a class by inference, in the order of their names."""
        if class_iri is None:
            return (self.by_name[name] for name in sorted(self.by_name))
        self.ensure_derived()
        found = filter(None, map(self.find_by_iri, self.reasoner.instances(class_iri)))
        return iter(sorted(found, key=lambda entity: entity.name))

    def snapshot(self) -> Snapshot:
        """Every entity, as of the last commit."""
        return Snapshot(seq=self.seq, entities=tuple(self.entities()), digest=self.digest)

    def stars(self, names: Iterable[str]) -> tuple[Star, ...]:
        """The triples about some entities, taken together. Raises UnknownName, Refused for the TBox's."""
        self.ensure_derived()
        iris = [v.iri(self.entity(name).iri) for name in names]
        leaving = frozenset(iris)
        return tuple(
            entity_reading.read_entity_triples(self.reasoner, self.classes, iri, self.seq, leaving, self.tbox)
            for iri in iris
        )

    def class_table(self) -> Iterator[ClassInfo]:
        """The classes with the number of entities of each, asserted and inferred."""
        return self.classes.with_counts(self.by_name.values())

    def abox(self) -> list[Triple]:
        """The asserted triples that are not the TBox's."""
        tbox = self.tbox
        return [t for said in self.reasoner.by_subject() for t in said if t not in tbox]

    def inferred(self, name: str | None = None) -> Iterator[Triple]:
        """What follows and was not said, about one entity or all. Raises UnknownName."""
        self.ensure_derived()
        for entity in [self.entity(name)] if name is not None else self.entities():
            yield from sorted(self.reasoner.inferred(v.iri(entity.iri), None, None))

    def with_progress(self, items: Iterable[T]) -> Iterator[T]:
        """The items, for long work on them: the node tells meanwhile that it lives."""
        return with_progress(items, self.progress)

    def all_derived(self) -> DerivedChanges:
        """What is computed and what is set aside."""
        self.ensure_derived()
        return self.derived_facts.all()

    def placed(self) -> tuple[Placed, ...]:
        """Where everything is."""
        return tuple(map(Placed.of, self.by_name.values()))

    def is_asserted(self, triple: Triple) -> bool:
        """Is it asserted?"""
        return any(self.reasoner.asserted(*triple))

    def types_of(self, entity: Entity) -> tuple[str, ...]:
        """The classes of an entity as it is now, by what is computed, too."""
        return self.classes.type_names(self.reasoner.types(v.iri(entity.iri)))

    def find_by_iri(self, iri: Term) -> Entity | None:
        """The entity with this IRI, as of the last commit."""
        return entity_changes.known(self.by_name, iri)

    # What is computed of where things are

    def derive_all(self) -> None:
        """Work out where everything is, if that was not done since the start.

        Whoever asks what follows needs it, and the first commit.
        """
        while self.derive_some():
            self.progress()

    def derive_for(self, transaction: Transaction) -> None:
        """As much of that as a transaction needs.

        If it only puts things somewhere and nobody asserts where things are, it suffices to know where all of
        them are; what holds of them is worked out between other work.
        """
        while not self._derived_all and not (self.derives_at_commits and _only_places(transaction)):
            self.derive_some()
            self.progress()

    def derive_some(self) -> bool:
        """Do a part of that, some tens of milliseconds; whether there is more to do."""
        if self._derived_all:
            return False
        following, self._derivation = self._derivation or self._derivation_steps(), None
        with gc_pause.uncollected(freeze=True):
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
        """Let the reasoner have what is computed of where things are, if it has not."""
        if not self.has_derived:
            self.derive_all()

    def _crowds(self, names: Collection[str] | None) -> list[str]:
        """The sentences on crowds, if relations are computed."""
        if not self.derives_at_commits or names is None:
            self.derive_all()
        return (
            []
            if self.derived_facts.computed.is_idle
            else self.derived_facts.computed.facts.space.crowds(names)
        )

    def _facts(self) -> Facts | None:
        """The relations that are computed, if any are, with their solids."""
        self.derive_all()
        return None if self.derived_facts.computed.is_idle else self.derived_facts.computed.facts

    @contextmanager
    def predicted_places(self, transaction: Transaction) -> Iterator[None]:
        """Within, a process of its own works out where everything is after a large transaction."""
        computed = self.derived_facts.computed
        if _HAS_CORES and not computed.is_idle:
            self._predict_places(transaction)
        try:
            yield
        finally:
            computed.facts.give_up_ahead()

    def _predict_places(self, transaction: Transaction) -> None:
        coming, facts = (
            new_entities.predict_new_entities(transaction, self.classes),
            self.derived_facts.computed.facts,
        )
        if coming is not None and len(self) <= len(coming):
            foreseen = Foreseen(facts.space.limits, self.placed(), coming)
            with suppress(OSError):  # then it is worked out here
                facts.work_ahead(Ahead(foreseen, self.progress))

    def clean_up(self) -> None:
        """What a commit leaves to be done when nobody waits for it."""
        self.derived_facts.computed.facts.forget()

    # Changing

    def exchange_tbox(self, tbox: frozenset[Triple], reasoner: Reasoner) -> None:
        """Let another TBox hold; `reasoner` holds it, and nothing else yet."""
        self.tbox, self.reasoner = tbox, reasoner
        self.classes = ClassTable(reasoner)
        self.derived_facts = DerivedFacts(reasoner, self.classes.limits, self.progress)

    def apply_commit(self, commit: Commit) -> None:
        """Let the entities show a commit that the reasoner has taken in already."""
        self.seq, self.digest = commit.seq, commit.digest
        self.places.update(commit.names, commit.retracted, commit.inserted)
        for gone in commit.removed:
            del self.by_name[gone.name]
        self.update_entities(commit.changed)

    def revert_entities(self, commit: Commit, before: Mapping[str, Entity | None], digest: str) -> None:
        """Let the entities be as before the last commit: those that it touched, None for what was not there.

        `digest` is that of the commit before.
        """
        self.seq, self.digest = commit.seq - 1, digest
        self.places.update(commit.names, commit.inserted, commit.retracted)
        for name, entity in before.items():
            if entity is None:
                self.by_name.pop(name, None)
            else:
                self.by_name[name] = entity

    def update_entities(self, changed: Iterable[Entity]) -> None:
        """Let entities be as these."""
        for entity in changed:
            self.by_name[entity.name] = entity


def _only_places(transaction: Transaction) -> bool:
    """Does it only add things, and say of others where they are, how large and what they are called?"""
    if transaction.remove or transaction.require or transaction.retract or transaction.insert:
        return False
    return not (
        any(edit.carry or edit.set or edit.unset or edit.only_if for edit in transaction.edit)
        or any(new.set for new in transaction.add)
    )
