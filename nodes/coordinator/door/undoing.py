"""Undo: the knowledge base works out which commits go together, and what takes them back."""

from __future__ import annotations

from nodes.coordinator.dialogues import Talk, ask
from nodes.coordinator.door.committing import changed, once, taken_with_classes
from nodes.coordinator.door.known_map import KnownMap
from schemas import errors, wording
from schemas.bridge import TakeBack
from schemas.commands import Undo
from schemas.replies import Changed


@once
def undo(view: KnownMap, command: Undo) -> Talk[Changed]:
    """Take back a commit."""
    commit = yield from ask(
        TakeBack(
            id=command.id,
            source=command.source,
            agent=command.agent,
            reason=command.reason,
            commit=command.commit,
            dry_run=command.dry_run,
            told=True,
        )
    )
    if commit is None:  # a dry run of what was done before
        return Changed(commit=None, text="nothing is left to undo")
    if not commit.undoes:
        raise errors.Refused(
            f"the id '{command.id}' is that of commit {commit.seq}, which took nothing back;"
            " give each command an id of its own"
        )
    yield from taken_with_classes(view, commit)
    first, *settling = commit.undoes
    text = f"undid commit {first}"
    if settling:
        text += f" and what settled after it ({wording.commits(settling)})"
    return changed(commit, text, names=commit.names)
