"""Undo: the knowledge base works out which commits go together, and what takes them back."""

from __future__ import annotations

from nodes.coordinator.dialogues import Question, Talk
from nodes.coordinator.door.committing import once, taken_with_classes
from nodes.coordinator.door.known_map import KnownMap
from schemas.commands import Undo
from schemas.commits import Effects
from schemas.replies import Changed


@once
def undo(view: KnownMap, command: Undo) -> Talk[Changed]:
    """Take back a commit."""
    commit: Effects = yield Question("undo", command)
    yield from taken_with_classes(view, commit)
    first, *settling = commit.undoes
    text = f"took back commit {first}" + (f" with the {len(settling)} that settled it" if settling else "")
    return Changed(commit=commit.seq, text=text, names=commit.names)
