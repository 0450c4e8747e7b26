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
from semmap.nodes.kb_node.storage import closure_cache, conclusions_format
from semmap.nodes.kb_node.storage.checkpoint_schedule import CheckpointSchedule
from semmap.nodes.kb_node.storage.encoding import commit_encoding
from semmap.nodes.kb_node.storage.journal import Checkpoint, Journal
from semmap.nodes.kb_node.storage.journal.sqlite_file import NotWritten
from semmap.nodes.kb_node.storage.journal.verification import verify
from semmap.nodes.runtime import gc_pause
from semmap.schemas import errors
from semmap.schemas.commits import Commit, Transaction
from semmap.schemas.entities import Entity
from semmap.schemas.explanations import Triple

LARGE: Final = 1_000_000
"""Triples."""

T = TypeVar("T")
C = TypeVar("C", Commit, Commit | None)

log = logging.getLogger(__name__)


class _DryRunDone(Exception):
    """A change was tried, up to where it would be durable. `seen` is what there was to see."""

    def __init__(self, seen: Any) -> None:
        super().__init__()
        self.seen = seen


class _Memento(NamedTuple):
    """A commit that is not durable yet, and the entities that it touched as they were before."""

    commit: Commit
    before: Mapping[str, Entity | None]
    """By name; None for one that was not there."""


class SemanticMap(MapState):
    """The ABox with its TBox: checked, explained, durable. Owned by one thread."""

    def __init__(
        self,
        journal: Journal,
        *,
        reasoner: Reasoner | None = None,
        progress: Callable[[], None] = lambda: None,
    ) -> None:
        """Rebuild the map from `journal`; `reasoner` is one that holds its TBox and no more, if there is one.

        `progress` is called between the steps of long work. Raises Refused when the journal is damaged.
        """
        self._journal = journal
        verify(journal, progress)
        start = journal.last_checkpoint(progress)
        tbox = self.tbox_at(start.seq)
        super().__init__(tbox, reasoner or closure_cache.reasoner(tbox, journal.path.parent), progress)
        self._applier = Applier(self)
        self._schedule = CheckpointSchedule(journal, start.seq)
        self.prepare: Callable[[Commit], Callable[[], None]] = lambda _: lambda: None
        """Told of each commit before it is checked; what it returns is called if that is not made."""
        self.is_sound = True
        """False when an unexpected error (no memory) may have left a change half done: then start anew."""
        self.on_failure: Callable[[], None] = lambda: None
        """Called when that happens."""
        self._inspect: Callable[[Commit], Any] | None = None
        """While a change is only tried: who looks at it."""
        self._undo_log: list[_Memento] | None = None
        """While commits are made together: what takes them back, in their order."""
        self._replay(start)

    def tbox_at(self, seq: int) -> frozenset[Triple]:
        """The TBox that held after commit `seq`. Raises Refused when it is damaged."""
        return frozenset(rdf.parse(self._journal.tbox(seq), f"the TBox in {self._journal.path}"))

    def take_derived_changes(self, commit: Commit) -> DerivedChanges:
        """What a commit changed of what is computed and set aside; it is told once."""
        return self._applier.derived_changes.pop(commit.seq, UNCHANGED)

    # Changing

    def commit(self, transaction: Transaction) -> Commit | None:
        """Apply, check and make durable; None when it changes nothing. On any error the map is as before.

        A command that comes a second time is answered with its first commit. That is looked up only when
        there is nothing to do or something is in the way, as the journal is: it takes no command twice.

        Raises PreconditionFailed; NameTaken; UnknownName for an intent about what is not there; Inconsistent
        (with the explanation); BadRequest for a star that does not make sense; Refused when it takes away
        from the TBox or the disk does not take the commit; NoAnswer, with the map not sound any more, when
        something unexpected happens: whether the commit is durable the journal knows.
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
        """What `change` commits. Raises NoAnswer for an error that nobody expects."""
        try:
            return change()
        except (errors.SemmapError, _DryRunDone):
            raise
        except Exception as error:
            self.is_sound = False
            self.on_failure()
            log.exception("a change may be half done")
            raise errors.NoAnswer(
                f"the knowledge base starts again from its journal, because a change failed in the middle:"
                f" {type(error).__name__}: {error}"
            ) from error

    def _commit(self, transaction: Transaction) -> Commit | None:
        self.derive_for(transaction)
        if transaction.is_quick:
            return self._make_commit(transaction)
        with gc_pause.uncollected(), self.predicted_places(transaction):
            return self._make_commit(transaction)

    def _make_commit(self, transaction: Transaction) -> Commit | None:
        plan, apply = planning.make_plan(self, transaction), self._applier.apply
        if plan is None:
            return None
        commit = planning.make_commit(transaction, plan, self.seq + 1)
        if self._inspect is not None:
            return self._accept(apply(commit, self._write, self._with_notes))
        rollback, begun = self.prepare(commit), commit_encoding.early(commit, self.digest)
        write, noted = partial(self._write, begun=begun), partial(self._with_notes, begun=begun)
        try:
            return self._accept(apply(commit, write, noted))
        except BaseException:
            rollback()
            if begun is not None:
                begun.give_up()
            raise

    def _with_notes(self, commit: Commit, *, begun: commit_encoding.EarlyBody | None = None) -> Commit:
        """With a word on what it says of places and is not so. The body that was `begun` has its entities."""
        if begun is not None:
            begun.expect(commit)
        doubts = self.places.conflict_notes(commit)
        return structs.replace(commit, notes=(*commit.notes, *doubts)) if doubts else commit

    def try_out(self, change: Callable[[], Commit | None], inspect: Callable[[Commit], T]) -> T | None:
        """What `inspect(commit)` sees once `change` would be durable; then all is taken back.

        None if it changes nothing, or was done before. Raises what `change` raises.
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

    def _write(
        self, commit: Commit, tbox: bytes | None = None, *, begun: commit_encoding.EarlyBody | None = None
    ) -> Commit:
        """The commit, durable and with its digest. Raises NotWritten; _DryRunDone if it is only tried."""
        if self._inspect is not None:
            raise _DryRunDone(self._inspect(commit))
        return structs.replace(commit, digest=self._journal.append(commit, tbox, begun=begun).hex())

    def replace_tbox(self, transaction: Transaction, tbox: Iterable[Triple]) -> Commit:
        """Let another TBox hold, in one commit with the transaction's changes of the ABox.

        Raises Inconsistent, BadFile for what is no TBox, Refused when the map does not fit it or the disk
        does not take it. Then everything is as before.
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

        def make_durable(commit: Commit) -> Commit:
            tbox_validation.require_fit(self.abox(), before, self.classes)
            return self._write(commit, rdf.serialise(new, "ntriples"))

        return self._run_change(lambda: self._accept(self._applier.switch(commit, new, make_durable)))

    def restate(self, commit: Commit, tbox: bytes | None = None) -> Commit:
        """Commit what another journal has, under its number and in its author's name, as it is.

        `tbox` (N-Triples) is the one that it lets hold. Raises Inconsistent, BadRequest, NotWritten; then the
        map is as before.
        """
        self.derive_all()
        if tbox is None:
            return self._accept(self._applier.apply(commit, self._write))
        new = frozenset(rdf.parse(tbox, "the TBox"))
        return self._accept(self._applier.switch(commit, new, lambda whole: self._write(whole, tbox)))

    def commit_together(
        self, transactions: Sequence[Transaction]
    ) -> list[Commit | errors.SemmapError | None]:
        """Like `commit` for each by itself, in order, but durable together; errors are among the results.

        When the disk does not take them, all are refused and the map is as before.
        """
        log = self._undo_log = []
        self._applier.derived_changes.clear()
        results: list[Commit | errors.SemmapError | None] = []
        try:
            with self._journal.together():
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
        """Undo the last commit, of which the journal keeps nothing."""
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

    # Restarting

    def checkpoint_is_due(self, *, quiet: bool) -> bool:
        """Would the next start have much to replay? Unless it is `quiet`, very much? Another TBox is much."""
        return self._schedule.is_due(self.seq, quiet=quiet)

    @property
    def checkpoint_is_urgent(self) -> bool:
        """Would the next start have to replay most of the map?"""
        return self._schedule.is_urgent(self.reasoner)

    @property
    def is_large(self) -> bool:
        """Does a checkpoint take so long that nobody should wait for it without need?"""
        return len(self.reasoner) > LARGE

    def snapshot_for_checkpoint(self) -> Checkpoint:
        """The map as it is now, to be written down while it goes on changing. Takes some 0.2 us a triple."""
        self.ensure_derived()
        self._schedule.pictured()
        columns = self.reasoner.columns(self.tbox)
        return Checkpoint(
            seq=self.seq,
            triples=tuple(self.reasoner.set_aside() if columns is not None else self.abox()),
            columns=columns,
            entities=tuple(self.by_name.values()),
            read_by=conclusions_format.mark(),
        )

    def checkpoint(self) -> None:
        """Write down the whole map, so that the next start need not replay its history.

        Raises Refused when the disk does not take it; then the history is replayed.
        """
        if not self._schedule.is_written(self.seq):
            self._journal.checkpoint(self.snapshot_for_checkpoint(), self.progress)
            self.written(self.seq)

    def written(self, seq: int) -> None:
        """There is a checkpoint of the map after commit `seq`, made of the last picture."""
        self._schedule.written(seq)

    def _replay(self, start: Checkpoint) -> None:
        is_ours = start.read_by == conclusions_format.mark()
        if start.columns is not None and is_ours and self.reasoner.fill(start.columns):
            self.reasoner.believe(aside=start.triples)
            self.has_derived = True
        else:
            self._applier.change(insert=tuple(start.said()), lenient=True)
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
        if self.seq > start.seq or start.read_by != conclusions_format.mark():
            self.derive_all()  # else the entities have the classes that they have by their places


def _unchanged(commit: Commit) -> Commit:
    """One that is durable already."""
    return commit
