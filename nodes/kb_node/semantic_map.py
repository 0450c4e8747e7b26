"""The core of the knowledge base: one transaction in, one checked and durable commit out."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from typing import Any, Final, NamedTuple, TypeVar

from msgspec import structs

from semmap.nodes.kb_node import planning
from semmap.nodes.kb_node.applier import Applier
from semmap.nodes.kb_node.derived_facts import UNCHANGED, DerivedChanges
from semmap.nodes.kb_node.documents import rdf
from semmap.nodes.kb_node.documents.tbox import tbox_validation
from semmap.nodes.kb_node.entities import entity_reading
from semmap.nodes.kb_node.map_state import MapState
from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.nodes.kb_node.reasoner.rules.facts import Facts
from semmap.nodes.kb_node.shacl import violations
from semmap.nodes.kb_node.shacl.enforcement import ShapeEnforcement, ViolatesShapes
from semmap.nodes.kb_node.shacl.touched_individuals import TouchedIndividuals
from semmap.nodes.kb_node.storage import closure_cache, conclusions_format
from semmap.nodes.kb_node.storage.checkpointing import CheckpointSchedule
from semmap.nodes.kb_node.storage.encoding import commit_encoding
from semmap.nodes.kb_node.storage.journal import Checkpoint, Journal
from semmap.nodes.kb_node.storage.journal.sqlite_file import NotWritten
from semmap.nodes.kb_node.storage.journal.verification import verify
from semmap.nodes.runtime import memory
from semmap.schemas import errors
from semmap.schemas.commits import Commit, Transaction
from semmap.schemas.entities import Entity
from semmap.schemas.explanations import Triple

LARGE: Final = 1_000_000
"""Number of triples from which a map counts as large."""

T = TypeVar("T")
C = TypeVar("C", Commit, Commit | None)

log = logging.getLogger(__name__)


class _DryRunDone(Exception):
    """Ends a dry run just before the commit becomes durable. `seen` is the result of the inspection."""

    def __init__(self, seen: Any) -> None:
        super().__init__()
        self.seen = seen


class _Memento(NamedTuple):
    """A commit that is not durable yet, with the previous state of the entities that it touches."""

    commit: Commit
    before: Mapping[str, Entity | None]
    """By name; None for an entity that did not exist."""


class SemanticMap(MapState):
    """The ABox with its TBox: checked, explained, durable. Owned by one thread."""

    def __init__(
        self,
        journal: Journal,
        *,
        reasoner: Reasoner | None = None,
        progress: Callable[[], None] = lambda: None,
    ) -> None:
        """Rebuild the map from `journal`.

        `reasoner`, if given, holds the TBox of the map and nothing else. `progress` is called between the
        steps of long work. Raises Refused if the journal is damaged.
        """
        self._journal = journal
        verify(journal, progress)
        start = journal.last_checkpoint(progress)
        tbox = self.tbox_at(start.seq)
        super().__init__(tbox, reasoner or closure_cache.load_reasoner(tbox, journal.path.parent), progress)
        self._applier = Applier(self)
        self._schedule = CheckpointSchedule(journal, start.seq)
        self.prepare: Callable[[Commit], Callable[[], None]] = lambda _: lambda: None
        """Called with each commit before it is checked. The returned function is called if the commit is
        aborted."""
        self.is_sound = True
        """False if an unexpected error, such as lack of memory, may have left a change incomplete. The node
        must restart."""
        self.on_failure: Callable[[], None] = lambda: None
        """Called when `is_sound` becomes False."""
        self.enforcement: ShapeEnforcement | None = None
        """Validates new commits against the shapes of the TBox, if that is enabled."""
        self._inspect: Callable[[Commit], Any] | None = None
        """During a dry run: the function that inspects the commit."""
        self._undo_log: list[_Memento] | None = None
        """During `commit_together`: the mementos to roll back, in the order of the commits."""
        self._replay(start)

    def tbox_at(self, seq: int) -> frozenset[Triple]:
        """Return the TBox in force after commit `seq`. Raises Refused if it is damaged."""
        return frozenset(rdf.parse(self._journal.tbox(seq), f"the TBox in {self._journal.path}"))

    def take_derived_changes(self, commit: Commit) -> DerivedChanges:
        """Return how a commit changed the computed and suppressed facts, once."""
        return self._applier.derived_changes.pop(commit.seq, UNCHANGED)

    # Changes

    def commit(self, transaction: Transaction) -> Commit | None:
        """Apply a transaction, check it and make it durable. Return None if it changes nothing.

        On any error the map is as before. A repeated transaction returns its first commit. It is looked up in
        the journal only if there is nothing to do or if the transaction fails, because the journal accepts an
        id only once.

        Raises:
            PreconditionFailed: a precondition does not hold.
            NameTaken: the name of a new entity exists.
            UnknownName: an edited or removed entity does not exist.
            Inconsistent: the map would become inconsistent; the error has the explanation.
            BadRequest: the triples of an entity are invalid.
            Refused: it would change the TBox, or the commit cannot be written to disk.
            NoAnswer: an unexpected error occurred. The map is not sound any more, and only the journal knows
                whether the commit is durable.
        """
        if self._undo_log is None:
            self._applier.derived_changes.clear()
        try:
            made = self._run_change(lambda: self._commit(transaction))
        except errors.SemmapError:
            if not self.is_sound or (known := self._journal.commit_of(transaction.id)) is None:
                raise
            return known
        return made or self._journal.commit_of(transaction.id)

    def _run_change(self, change: Callable[[], C]) -> C:
        """Return the commit of `change`. Raises NoAnswer for an unexpected error."""
        try:
            return change()
        except (errors.SemmapError, ViolatesShapes, _DryRunDone):
            raise
        except Exception as error:
            self.is_sound = False
            self.on_failure()
            log.exception("a change may be incomplete")
            raise errors.NoAnswer(
                f"the knowledge base restarts from its journal, because a change failed:"
                f" {type(error).__name__}: {error}"
            ) from error

    def _commit(self, transaction: Transaction) -> Commit | None:
        self.derive_for(transaction)
        if transaction.is_quick:
            return self._make_commit(transaction)
        with memory.uncollected(), self.predicted_places(transaction):
            return self._make_commit(transaction)

    def _make_commit(self, transaction: Transaction) -> Commit | None:
        return self._run_valid(partial(self._make_valid_commit, transaction), self.enforcement)

    def _run_valid(
        self, change: Callable[[ShapeEnforcement | None], C], enforcement: ShapeEnforcement | None
    ) -> C:
        """Return the commit of `change(enforcement)`. Raises Refused for violations that are new with it."""
        try:
            return change(enforcement)
        except ViolatesShapes as violation:
            self._require_known(violation)
            return change(None)

    def _require_known(self, violation: ViolatesShapes) -> None:
        """Raise Refused for violations that the map did not have before the commit, which is reverted."""
        enforcement = self.enforcement
        before = enforcement.find_violations(violation.touched, self.reasoner) if enforcement else []
        known = {structs.replace(result, shape="") for result in before}  # a new TBox may have other names
        if new := [one for one in violation.results if structs.replace(one, shape="") not in known]:
            raise errors.Refused(violations.describe_rejection(new, self))

    def _make_valid_commit(
        self, transaction: Transaction, enforcement: ShapeEnforcement | None
    ) -> Commit | None:
        plan = planning.make_plan(self, transaction)
        if plan is None:
            return None
        commit = planning.make_commit(transaction, plan, self.seq + 1)
        # edits keep one pose for each entity, but triples from outside may state several
        apply = partial(self._applier.apply, strict=bool(transaction.insert), is_new=True)
        validated: Callable[..., Commit] = self._write
        if enforcement is not None and (touched := enforcement.begin(commit, self.reasoner)) is not None:
            validated = partial(self._write_valid, enforcement=enforcement, touched=touched)
            apply = partial(apply, reclassified=touched.add_reclassified)
        if self._inspect is not None:
            return self._accept(apply(commit, validated, self._with_notes))
        rollback, begun = self.prepare(commit), commit_encoding.begin_body(commit, self.digest)
        write, noted = partial(validated, begun=begun), partial(self._with_notes, begun=begun)
        try:
            return self._accept(apply(commit, write, noted))
        except BaseException:
            rollback()
            if begun is not None:
                begun.discard()
            raise

    def _with_notes(self, commit: Commit, *, begun: commit_encoding.EarlyBody | None = None) -> Commit:
        """Return the commit with notes on asserted locations that contradict the geometry.

        The encoding that was begun early receives the entities of the commit.
        """
        if begun is not None:
            begun.expect(commit)
        doubts = self.places.conflict_notes(commit)
        return structs.replace(commit, notes=(*commit.notes, *doubts)) if doubts else commit

    def try_out(self, change: Callable[[], Commit | None], inspect: Callable[[Commit], T]) -> T | None:
        """Run `change` up to the point of durability, return `inspect(commit)`, and roll back.

        Return None if the change has no effect or was made before. Raises what `change` raises.
        """
        self._inspect = inspect
        try:
            change()
        except _DryRunDone as tried:
            seen: T = tried.seen
            return seen
        finally:
            self._inspect = None
        return None

    def _write_valid(
        self,
        commit: Commit,
        *,
        enforcement: ShapeEnforcement,
        touched: TouchedIndividuals,
        begun: commit_encoding.EarlyBody | None = None,
    ) -> Commit:
        """Write the commit. Raises ViolatesShapes before that."""
        derived = self._applier.derived_changes.get(commit.seq, UNCHANGED)
        enforcement.require(touched.find(commit, derived), self.reasoner)
        return self._write(commit, begun=begun)

    def _write(
        self, commit: Commit, tbox: bytes | None = None, *, begun: commit_encoding.EarlyBody | None = None
    ) -> Commit:
        """Write the commit to the journal and return it with its digest.

        Raises NotWritten; _DryRunDone in a dry run.
        """
        if self._inspect is not None:
            raise _DryRunDone(self._inspect(commit))
        return structs.replace(commit, digest=self._journal.append(commit, tbox, begun=begun).hex())

    def replace_tbox(
        self,
        transaction: Transaction,
        tbox: Iterable[Triple],
        *,
        closed: Facts | None = None,
        strict: bool = False,
    ) -> Commit:
        """Replace the TBox and apply the ABox changes of the transaction, in one commit.

        `closed` is the closure of the TBox, if it is known. If `strict`, entities with several poses or sizes
        are rejected.

        Raises Inconsistent, BadFile if `tbox` is not a TBox, and Refused if the map does not fit it or the
        disk is full. Then everything is as before.
        """
        if (known := self._journal.commit_of(transaction.id)) is not None:
            return known
        new = frozenset(tbox)
        plan = planning.Plan(
            retracted=(*transaction.retract, *sorted(self.tbox - new)),
            inserted=(*transaction.insert, *sorted(new - self.tbox)),
            notes=(),
        )
        commit = planning.make_commit(transaction, plan, self.seq + 1, tbox=True)
        self.derive_all()
        before = self.classes
        enforcement = None if self.enforcement is None else ShapeEnforcement(new)

        def replace(enforced: ShapeEnforcement | None) -> Commit:
            def make_durable(commit: Commit) -> Commit:
                tbox_validation.require_fit(self.abox(), before, self.classes)
                if enforced is not None:
                    enforced.require(None, self.reasoner)
                return self._write(commit, rdf.serialise(new, "ntriples"))

            return self._accept(self._applier.switch(commit, new, make_durable, closed, strict=strict))

        made = self._run_change(lambda: self._run_valid(replace, enforcement))
        self.enforcement = enforcement
        return made

    def restate(self, commit: Commit, tbox: bytes | None = None) -> Commit:
        """Commit a commit of another journal with its number and author.

        `tbox` (N-Triples) is the TBox that it sets, if any. Raises Inconsistent, BadRequest, NotWritten; then
        the map is as before.
        """
        self.derive_all()
        if tbox is None:
            return self._accept(self._applier.apply(commit, self._write))
        new = frozenset(rdf.parse(tbox, "the TBox"))
        return self._accept(self._applier.switch(commit, new, lambda whole: self._write(whole, tbox)))

    def commit_together(
        self, transactions: Sequence[Transaction]
    ) -> list[Commit | errors.SemmapError | None]:
        """Commit each transaction by itself, in order, but make all of them durable with one write.

        Errors are part of the results. If the disk does not accept the write, all transactions fail and the
        map is as before.
        """
        log = self._undo_log = []
        self._applier.derived_changes.clear()
        results: list[Commit | errors.SemmapError | None] = []
        try:
            with self._journal.batch():
                for transaction in transactions:
                    try:
                        results.append(self.commit(transaction))
                    except NotWritten:
                        raise
                    except errors.SemmapError as error:
                        if not self.is_sound:
                            raise
                        results.append(error)
        except BaseException as error:
            if not self.is_sound:
                raise
            for memento in reversed(log):
                self._roll_back(memento)
            if not isinstance(error, NotWritten):
                raise
            return [error] * len(transactions)
        finally:
            self._undo_log = None
        return results

    def _roll_back(self, memento: _Memento) -> None:
        """Roll back the last commit, which the journal does not contain."""
        commit, before = memento
        self._applier.reverse(commit, before)
        self.revert_entities(commit, before, self._journal.digest(commit.seq - 1).hex())

    def _accept(self, commit: Commit) -> Commit:
        if self._undo_log is not None:
            before = {name: self.by_name.get(name) for name in commit.names}
            self._undo_log.append(_Memento(commit, before))
        self._schedule.count(commit)
        self.apply_commit(commit)
        return commit

    # Restart

    def checkpoint_is_due(self, *, quiet: bool) -> bool:
        """Return whether the next start would replay much, or very much if the map is not `quiet`.

        A replaced TBox counts as much.
        """
        return self._schedule.is_due(self.seq, quiet=quiet)

    @property
    def checkpoint_is_urgent(self) -> bool:
        """Return whether the next start would have to replay most of the map."""
        return self._schedule.is_urgent(self.reasoner)

    @property
    def is_large(self) -> bool:
        """Return whether a checkpoint takes so long that a client should not wait for it."""
        return len(self.reasoner) > LARGE

    def snapshot_for_checkpoint(self) -> Checkpoint:
        """Return a snapshot of the map that can be written while the map changes.

        Takes about 0.2 us a triple.
        """
        self.ensure_derived()
        self._schedule.mark_snapshot()
        columns = self.reasoner.columns(self.tbox)
        return Checkpoint(
            seq=self.seq,
            triples=tuple(self.reasoner.suppressed() if columns is not None else self.abox()),
            columns=columns,
            entities=tuple(self.by_name.values()),
            read_by=conclusions_format.format_mark(),
        )

    def checkpoint(self) -> None:
        """Write a checkpoint of the map, so that the next start does not replay its history.

        Raises Refused if the disk does not accept it; then the next start replays the history.
        """
        if not self._schedule.is_written(self.seq):
            self._journal.checkpoint(self.snapshot_for_checkpoint(), self.progress)
            self.written(self.seq)

    def written(self, seq: int) -> None:
        """Record that the last snapshot was written as a checkpoint of commit `seq`."""
        self._schedule.mark_written(seq)

    def _replay(self, start: Checkpoint) -> None:
        is_ours = start.read_by == conclusions_format.format_mark()
        if start.columns is not None and is_ours and self.reasoner.fill(start.columns):
            self.reasoner.update_computed(suppress=start.triples)
            self.has_derived = True
        else:
            self._applier.change(insert=tuple(start.all_triples()), lenient=True)
        self.seq, self.digest = start.seq, self._journal.digest(start.seq).hex()
        if start.seq == 0:
            self.update_entities(entity_reading.read_tbox_entities(self.reasoner, self.classes))
        elif is_ours:
            self.update_entities(start.entities)
        else:
            read = (entity_reading.read_again(self.reasoner, self.classes, e) for e in start.entities)
            self.update_entities(entity for entity in read if entity is not None)
        for commit in self._journal.commits(after=start.seq):
            try:
                if commit.tbox:
                    made = self._applier.switch(commit, self.tbox_at(commit.seq), _unchanged)
                else:
                    made = self._applier.apply(commit, _unchanged)
            except errors.SemmapError as error:
                raise errors.Refused(f"commit {commit.seq} no longer fits its TBox: {error.text}") from None
            self._accept(made)
            self.progress()
        if self.seq > start.seq or start.read_by != conclusions_format.format_mark():
            self.derive_all()  # otherwise the entities have the classes that follow from poses


def _unchanged(commit: Commit) -> Commit:
    """Return a commit that is already durable."""
    return commit
