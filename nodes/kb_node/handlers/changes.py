"""Handlers for changes of the map: one transaction, several, or an undo."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from typing import Protocol, TypeVar

from semmap.nodes.kb_node import undo
from semmap.nodes.kb_node.answers import dry_runs
from semmap.nodes.kb_node.documents import term_syntax
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.storage.journal import Journal
from semmap.nodes.kb_node.storage.journal.sqlite_file import NotWritten
from semmap.ontology.entity_triples import find_earlier_names
from semmap.schemas import errors
from semmap.schemas.bridge import MadeBy, Outcome, TakeBack, Transactions
from semmap.schemas.calls import Handler, by_verb
from semmap.schemas.commits import Commit, Effects, Transaction

Report = Callable[[str], None]
ReportProgress = Callable[[str], AbstractContextManager[Report]]
"""Context for a large change that reports its progress in the heartbeat. The text begins with a word of
WORKING."""


class PublishCommit(Protocol):
    """Publishes a commit, `at_once` or after the reply is sent.

    `told` is True if the reply tells the coordinator about the commit.
    """

    def __call__(self, commit: Commit, /, *, told: bool, at_once: bool) -> None:  # noqa: D102
        ...


_FEW = 1000
"""Entities that may be added or removed without a progress report."""
C = TypeVar("C", Commit, Commit | None)


class ChangeHandlers:
    """Commits changes: journal (durable), reply, publish."""

    def __init__(
        self,
        semantic_map: SemanticMap,
        journal: Journal,
        *,
        publish: PublishCommit,
        on_write_error: Callable[[NotWritten], None],
        report_progress: ReportProgress,
    ) -> None:
        """Create the handlers. `publish` is called with each new commit, in order, before the reply.

        `on_write_error` is called with each error of the disk.
        """
        self._map = semantic_map
        self._journal = journal
        self._publish = publish
        self._on_write_error = on_write_error
        self._report_progress = report_progress

    def handlers(self) -> dict[str, Handler]:
        """Return the handlers by command."""
        return by_verb(
            Transaction.answered_by(self.on_commit),
            Transactions.answered_by(self.on_commits),
            TakeBack.answered_by(self.on_undo),
            MadeBy.answered_by(self.on_made_by),
        )

    def on_commit(self, transaction: Transaction) -> Effects | None:
        """Commit one transaction."""
        term_syntax.require_triples(transaction.insert)
        coming, going = len(transaction.add), len(transaction.remove)
        if coming + going <= _FEW:
            return self._commit(transaction)
        file = transaction.reason.removeprefix("load ") or "a file"
        with self._report_progress(f"loading {file}" if coming else "removing entities") as report:
            report(f"{coming or going:,} entities to check and write")
            return self._commit(transaction)

    def _commit(self, transaction: Transaction) -> Effects | None:
        return self.run_change(
            lambda: self._map.commit(transaction), transaction.dry_run, told=transaction.told
        )

    def on_commits(self, several: Transactions) -> tuple[Outcome, ...]:
        """Commit several transactions, each by itself, with one write.

        Raises BadRequest, with nothing done, if a triple is not valid RDF.
        """
        for transaction in several.transactions:
            term_syntax.require_triples(transaction.insert)
            if transaction.dry_run:
                raise errors.BadRequest("a dry run cannot be combined with other transactions")
        before = self._map.seq
        results = self._map.commit_together(several.transactions)
        for error in results:
            if isinstance(error, NotWritten):
                self._on_write_error(error)
        for transaction, result in zip(several.transactions, results, strict=True):
            if isinstance(result, Commit) and result.seq > before:
                before = result.seq
                self._publish(result, told=transaction.told, at_once=False)
        return tuple(map(_outcome, results))

    def on_undo(self, command: TakeBack) -> Effects | None:
        """Undo a commit."""

        def change() -> Commit:
            return undo.undo(self._map, self._journal, command, self._undoing)

        return self.run_change(change, command.dry_run, told=command.told)

    @contextmanager
    def _undoing(self, target: Commit) -> Iterator[None]:
        """Report the progress of an undo, if it is large."""
        count = len(target.changed) + len(target.removed)
        if count <= _FEW:
            yield
            return
        with self._report_progress(f"undoing commit {target.seq}") as report:
            report(f"{count:,} entities to check and write")
            yield

    def on_made_by(self, query: MadeBy) -> tuple[Effects | None, ...]:
        """Return the effects of the commits with these transaction ids."""
        return tuple(effects(self._journal.commit_of(id_)) for id_ in query.ids)

    def run_change(
        self, change: Callable[[], Commit | None], dry_run: bool, *, told: bool = False
    ) -> Effects | None:
        """Run `change`, publish its commit and return the effects; in a dry run only return them."""
        if dry_run:
            return dry_runs.dry_run(self._map, change)
        return effects(self.commit_and_publish(change, told=told))

    def commit_and_publish(self, change: Callable[[], C], *, told: bool = False, at_once: bool = False) -> C:
        """Run `change` and publish its commit, unless it is the result of a repeated command.

        `at_once` publishes before the reply, because further commits follow before it.
        """
        before = self._map.seq
        try:
            commit = change()
        except NotWritten as error:
            self._on_write_error(error)
            raise
        if commit is not None and commit.seq > before:
            self._publish(commit, told=told and not commit.tbox, at_once=at_once)
        return commit


def effects(commit: Commit | None) -> Effects | None:
    """Return the effects of a commit on the entities, or None."""
    return None if commit is None else Effects.of(commit, find_earlier_names(commit))


def _outcome(result: Commit | errors.SemmapError | None) -> Outcome:
    if isinstance(result, errors.SemmapError):
        return Outcome(error=errors.to_message(result))
    return Outcome(commit=effects(result))
