"""Sends a transaction to the knowledge base, and makes commands idempotent by their id."""

from __future__ import annotations

import functools
import gc
import uuid
from collections.abc import Callable
from typing import Any, TypeVar

from msgspec import structs

from semmap.nodes.coordinator.commands.map_view import MapView
from semmap.nodes.coordinator.kb_coroutines import KbCoroutine, ask
from semmap.nodes.runtime import memory
from semmap.nodes.runtime.class_names import ClassNames
from semmap.schemas import errors
from semmap.schemas.bridge import MadeBy
from semmap.schemas.commands import Classes, Command
from semmap.schemas.commits import Effects, Transaction
from semmap.schemas.replies import Changed

C = TypeVar("C", bound=Command)
Change = Callable[[MapView, C], KbCoroutine[Changed]]


def idempotent(change: Change[C]) -> Change[C]:
    """Make a command idempotent: if it is sent again under the same id, return its first result.

    The knowledge base executes an id only once and answers it with the first commit, so the command is simply
    executed again. If it fails, changes nothing or returns an old commit, one more request finds the earlier
    result. A command that is sent only once needs no additional request.
    """

    @functools.wraps(change)
    def execute(view: MapView, command: C) -> KbCoroutine[Changed]:
        if getattr(command, "dry_run", False):
            tried = yield from change(view, structs.replace(command, id=new_id()))
            return structs.replace(
                tried, dry_run=True, text=f"dry run, nothing changed; it would be: {tried.text}"
            )
        if not command.id:
            return (yield from change(view, structs.replace(command, id=new_id())))
        known_seq = view.seq
        try:
            changed = yield from change(view, command)
        except (errors.Refused, errors.BadRequest):
            if done := (yield from find_earlier_result(command)):
                return done
            raise
        if changed.commit is not None and changed.commit > known_seq:
            return changed
        return (yield from find_earlier_result(command)) or changed

    return execute


def find_earlier_result(command: Command) -> KbCoroutine[Changed | None]:
    """Return the result of an earlier command with this id, if there was one."""
    (commit,) = yield from ask(MadeBy(ids=(command.id,)))
    if commit is None:
        return None
    names = tuple(entity.name for entity in commit.changed) or tuple(gone.name for gone in commit.removed)
    return Changed(commit=commit.seq, text=f"already done: {commit.reason}", names=names)


def commit(view: MapView, transaction: Transaction) -> KbCoroutine[Effects | None]:
    """Commit a transaction and apply it to the view. Return None if it changes nothing."""
    return (yield from apply(view, (yield from ask(view.reserve(transaction)))))


def apply(view: MapView, commit: Effects | None) -> KbCoroutine[Effects | None]:
    """Apply a commit to the view, so that the next command sees it. Reload the map if it is abridged."""
    if commit is None or commit.trial is not None:
        return commit
    known = view.take(commit)
    view.confirm(commit.seq, commit.digest)
    if not known and commit.abridged is not None:
        yield from reload_map(view)
    return commit


def reload_map(view: MapView) -> KbCoroutine[None]:
    """Reload the map from the knowledge base, page by page."""
    pages = view.begin_pages()
    try:
        while not pages.are_complete:
            pages.take((yield from ask(pages.query)))
    except BaseException:
        view.cancel_pages()
        raise
    view.begin(pages.snapshot)
    memory.trim()
    gc.freeze()  # most of the map stays as it is, so the collector does not have to visit it again


def apply_with_classes(view: MapView, commit: Effects) -> KbCoroutine[None]:
    """Apply a commit that may have replaced the TBox, and reload the classes."""
    yield from apply(view, commit)
    if commit.tbox and commit.trial is None:
        view.classes = ClassNames((yield from ask(Classes())))


def new_id() -> str:
    """Return a new id, for a command without one."""
    return uuid.uuid4().hex


def make_reply(commit: Effects | None, text: str, *, notes: tuple[str, ...] = (), **fields: Any) -> Changed:
    """Return the reply to a command that has made `commit`, or would make it (dry run).

    `fields` are fields of `Changed`.
    """
    if commit is None:
        return Changed(commit=None, text=text, notes=notes, **fields)
    fields["notes"] = (*notes, *commit.notes)
    if (trial := commit.trial) is None:
        return Changed(commit=commit.seq, text=text, **fields)
    return Changed(commit=None, text=text, follows=trial.gained, no_longer_follows=trial.lost, **fields)
