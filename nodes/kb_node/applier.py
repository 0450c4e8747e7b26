"""Applies commits to the reasoner with checks and effects, before they are durable, and reverts them."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Set
from itertools import chain, islice
from typing import Final

from msgspec import structs

from semmap.nodes.kb_node import preconditions, proofs
from semmap.nodes.kb_node.derived_facts import DerivedChanges
from semmap.nodes.kb_node.documents.tbox import tbox_validation
from semmap.nodes.kb_node.entities import entity_changes, entity_reading
from semmap.nodes.kb_node.entities.fast_reading import Patterns
from semmap.nodes.kb_node.map_state import MapState
from semmap.nodes.kb_node.places import truncate_notes
from semmap.nodes.kb_node.progress import split_batches, with_progress
from semmap.nodes.kb_node.reasoner import Change, Inconsistent
from semmap.nodes.kb_node.reasoner.rules.facts import Facts
from semmap.ontology import vocabulary as v
from semmap.schemas.commits import Commit
from semmap.schemas.entities import Entity
from semmap.schemas.explanations import Term, Triple

PART: Final = 250_000
"""Triples that the reasoner takes in one call, a second or two. Smaller parts take longer in total."""


class Applier:
    """Changes the reasoner of a map. The entities change only with `MapState.apply_commit`."""

    def __init__(self, state: MapState) -> None:
        """Change `state`."""
        self._state = state
        self._patterns = Patterns()
        self.derived_changes: dict[int, DerivedChanges] = {}
        """The changes of computed facts by recent commits, until they are read."""

    def apply(
        self,
        commit: Commit,
        make_durable: Callable[[Commit], Commit],
        noted: Callable[[Commit], Commit] = lambda commit: commit,
        *,
        strict: bool = False,
        is_new: bool = False,
        reclassified: Callable[[frozenset[Term]], None] = lambda _: None,
    ) -> Commit:
        """Return the commit, durable and with its effects.

        Raises Inconsistent, and what `make_durable` raises.

        On any error everything is as before. `noted` adds notes when the reasoner has the change already. If
        `strict`, entities with several poses or sizes are rejected. If the commit `is_new`, so are equal
        individuals with different ones. `reclassified` receives the individuals whose classes or equal
        individuals have changed, and others whose asserted triples have.
        """
        state = self._state
        subjects = preconditions.subjects(commit.retracted, commit.inserted)
        known = state.reasoner.mentioned(subjects)
        about = (
            entity_reading.find_owners(state.reasoner, state.classes, s)
            for s in with_progress(known, state.progress)
        )
        owners, new = (subjects.union(*about), subjects - known) if known else (subjects, subjects)
        state.derived_facts.begin()
        restores = bool(commit.undoes)
        contradicted = state.derived_facts.contradicted.keys() if restores else frozenset()
        lenient = restores or not state.derives_at_commits
        change = self.change(delete=commit.retracted, insert=commit.inserted, lenient=lenient)
        try:
            reclassified(change.others)
            if not lenient:
                self._require_agreement(commit)
            commit = noted(self._with_effects(commit, owners, change, new, strict=strict, is_new=is_new))
            del owners, subjects, known, new, change  # for a large commit these take a third of the memory
            if state.derives_at_commits:
                commit = self._with_places(commit)
                reclassified(state.derived_facts.reclassified)
            if restores and state.derives_at_commits:
                self._require_no_more_than(contradicted)
            commit = make_durable(commit)
        except BaseException:
            self.reverse(commit, {name: state.by_name.get(name) for name in commit.names})
            raise
        return commit

    def switch(
        self,
        commit: Commit,
        tbox: frozenset[Triple],
        make_durable: Callable[[Commit], Commit],
        closed: Facts | None = None,
        *,
        strict: bool = False,
    ) -> Commit:
        """Apply a commit that replaces the TBox: everything is computed again in a new reasoner.

        `closed` is the closure of the TBox, if it is known. If `strict`, entities with several poses or sizes
        are rejected.
        """
        state = self._state
        facts = [t for t in (*commit.retracted, *commit.inserted) if t not in state.tbox and t not in tbox]
        owners = self._find_owners(facts)
        before = state.tbox, state.reasoner, state.classes, state.derived_facts
        abox = {*state.abox(), *commit.inserted}.difference(commit.retracted, tbox)
        try:
            state.exchange_tbox(tbox, tbox_validation.compile_tbox(tbox, closed=closed))
            self.change(insert=abox, lenient=True)
            concerned = {v.iri(entity.iri) for entity in state.by_name.values()}
            concerned.update(i for c in state.classes.spatial for i in state.reasoner.instances(c))
            owners |= self._find_owners(facts)
            commit = self._with_effects(
                commit, owners, Change(frozenset(concerned)), set(), strict=strict, is_new=strict
            )
            if state.derives_at_commits:
                commit = self._with_all_places(commit, before[-1].suppressed.keys())
            commit = make_durable(commit)
        except BaseException:
            state.tbox, state.reasoner, state.classes, state.derived_facts = before
            raise
        return commit

    def _find_owners(self, triples: Collection[Triple]) -> set[Term]:
        """Return the individuals that the triples describe now, directly or by their parts."""
        state = self._state
        subjects = preconditions.subjects(triples)
        about = (entity_reading.find_owners(state.reasoner, state.classes, s) for s in subjects)
        return subjects.union(*about)

    def reverse(self, commit: Commit, before: Mapping[str, Entity | None]) -> None:
        """Revert the reasoner to before the last commit; `before` holds the entities of that state."""
        state = self._state
        self.change(delete=commit.inserted, insert=commit.retracted, lenient=True)
        for subject in {s for s, p, _ in chain(commit.inserted, commit.retracted) if p == v.ENTITY_NAME}:
            v.give_name(subject, entity_reading.stated_name(state.reasoner.about(subject)))
        if not state.derives_at_commits:
            return
        after: dict[str, Entity | None] = {departed.name: None for departed in commit.removed}
        after.update((entity.name, entity) for entity in commit.changed)
        state.derived_facts.follow(
            changed=[entity for entity in before.values() if entity is not None],
            removed=[name for name, entity in before.items() if entity is None],
            before=lambda name: after[name] if name in after else state.by_name.get(name),
            retracted=commit.inserted,
            inserted=commit.retracted,
        )

    def change(
        self, *, delete: Collection[Triple] = (), insert: Collection[Triple], lenient: bool = False
    ) -> Change:
        """Pass triples to the reasoner and return its changes. Raises Inconsistent.

        If `lenient`, asserted locations that contradict the rest are suppressed.
        """
        state = self._state
        try:
            if len(delete) + len(insert) <= PART or not state.reasoner.is_compiled:
                return state.derived_facts.change(delete, insert, lenient=lenient)
            return self._change_in_parts(delete, insert, lenient)
        except Inconsistent as error:
            raise proofs.to_error(error, about=insert) from None

    def _change_in_parts(
        self, delete: Collection[Triple], insert: Collection[Triple], lenient: bool
    ) -> Change:
        """Pass a large change to the reasoner in parts.

        A part of a consistent map is consistent, so no valid change is rejected.
        """
        state = self._state
        reasoner, changes = state.derived_facts, list[Change]()
        deleted = inserted = 0
        try:
            for part in split_batches(delete, PART, state.progress):
                changes.append(reasoner.change(part, (), lenient=lenient))
                deleted += len(part)
            for part in split_batches(insert, PART, state.progress):
                changes.append(reasoner.change((), part, lenient=lenient))
                inserted += len(part)
        except BaseException:
            reasoner.change(tuple(islice(insert, inserted)), tuple(islice(delete, deleted)))
            raise
        return Change.together(changes)

    def _with_effects(
        self,
        commit: Commit,
        owners: Set[Term],
        change: Change,
        new: Set[Term],
        *,
        strict: bool = False,
        is_new: bool = False,
    ) -> Commit:
        state = self._state
        reading = entity_changes.Reading(
            state.reasoner, state.classes, self._patterns, state.progress, strict, is_new
        )
        return entity_changes.add_effects(commit, change, state.by_name, reading, owners=owners, new=new)

    def _with_places(self, commit: Commit) -> Commit:
        """Return `commit` with the entities whose classes change because of their locations."""
        state = self._state
        entities = state.by_name
        moved = state.derived_facts.follow(
            changed=commit.changed,
            removed=[departed.name for departed in commit.removed],
            before=entities.get,
            retracted=commit.retracted,
            inserted=commit.inserted,
        )
        self.derived_changes[commit.seq] = state.derived_facts.derived_changes
        crowds = state.places.crowds(commit.names)
        if crowds:
            commit = structs.replace(commit, notes=(*commit.notes, *crowds))
        commit = self._with_suppressed(commit, state.derived_facts.newly_suppressed)
        if not moved:
            return commit
        changed = {entity.name: entity for entity in commit.changed}
        removed = {departed.name for departed in commit.removed}
        for iri in sorted(moved):
            name = v.entity_name(iri)
            entity = changed.get(name) or (None if name in removed else entities.get(name))
            if entity is not None and v.iri(entity.iri) == iri:
                changed[name] = structs.replace(entity, types=state.types_of(entity))
        return structs.replace(commit, changed=tuple(e for n, e in changed.items() if e != entities.get(n)))

    def _with_all_places(self, commit: Commit, suppressed: Set[Triple]) -> Commit:
        """Do the same for a commit that replaces the TBox, where everything is computed again.

        `suppressed` are the facts that were suppressed before.
        """
        state = self._state
        removed = {departed.name for departed in commit.removed}
        after = {name: e for name, e in state.by_name.items() if name not in removed}
        after.update((entity.name, entity) for entity in commit.changed)
        state.derived_facts.fill(after)
        commit = self._with_suppressed(commit, sorted(state.derived_facts.suppressed.keys() - suppressed))
        for name, entity in after.items():
            after[name] = structs.replace(entity, types=state.types_of(entity))
        changed = tuple(e for name, e in after.items() if e != state.by_name.get(name))
        return structs.replace(commit, changed=changed)

    def _with_suppressed(self, commit: Commit, facts: Collection[Triple]) -> Commit:
        """Return `commit` with notes on the facts that are suppressed because of it."""
        if not facts:
            return commit
        return structs.replace(
            commit,
            notes=(*commit.notes, *truncate_notes(list(map(self._state.derived_facts.describe, facts)))),
        )

    def _require_agreement(self, commit: Commit) -> None:
        """Raise Inconsistent for a commit that contradicts an assertion that the geometry denies now."""
        try:
            self._state.derived_facts.require_agreement(commit.inserted)
        except Inconsistent as error:
            raise proofs.to_error(error) from None

    def _require_no_more_than(self, contradicted: Set[Triple]) -> None:
        """Raise Inconsistent if assertions contradict one another although the geometry denies neither.

        An undo may restore assertions that contradicted one another before, when the geometry denied one of
        them.
        """
        newly = {t: why for t, why in self._state.derived_facts.contradicted.items() if t not in contradicted}
        if newly:
            raise proofs.to_error(Inconsistent(newly[min(newly)]))
