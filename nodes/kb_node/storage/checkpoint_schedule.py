"""The schedule of checkpoints, which limit what the next start must replay."""

from __future__ import annotations

from collections.abc import Sized
from typing import Final

from semmap.nodes.kb_node.storage.journal import Journal
from semmap.schemas.commits import Commit

CHECKPOINT_EVERY: Final = 5000
"""Commits between checkpoints when idle."""
CHECKPOINT_AT_LATEST: Final = 20_000
CHECKPOINT_EVERY_TRIPLES: Final = 100_000
"""Changed triples between checkpoints when idle, or immediately if they are half of the map."""


class CheckpointSchedule:
    """A counter of changes since the last checkpoint."""

    def __init__(self, journal: Journal, checkpointed: int) -> None:
        """`checkpointed` is the last commit of the newest checkpoint."""
        self._journal = journal
        self._checkpointed = checkpointed
        self._changed = self._changed_then = 0
        """Triples changed, and those of them that are in the checkpoint."""
        self._changed_in_snapshot = 0

    def count(self, commit: Commit) -> None:
        """Count a new or undone commit."""
        self._changed += len(commit.inserted) + len(commit.retracted)

    def is_due(self, seq: int, *, quiet: bool) -> bool:
        """Return whether a start after commit `seq` would have much to replay, or very much unless `quiet`.

        A new TBox counts as much.
        """
        if quiet and self._changed - self._changed_then > CHECKPOINT_EVERY_TRIPLES:
            return True
        if quiet and self._journal.tbox_changes(after=self._checkpointed):
            return True
        return seq - self._checkpointed >= (CHECKPOINT_EVERY if quiet else CHECKPOINT_AT_LATEST)

    def is_urgent(self, triples: Sized) -> bool:
        """Return whether the next start would have to replay most of a map with these triples."""
        changed = self._changed - self._changed_then
        return changed > CHECKPOINT_EVERY_TRIPLES and 2 * changed >= len(triples)

    def is_written(self, seq: int) -> bool:
        """Return whether there is a checkpoint after commit `seq`."""
        return seq == self._checkpointed

    def mark_snapshot(self) -> None:
        """Record that the snapshot for the next checkpoint was taken."""
        self._changed_in_snapshot = self._changed

    def mark_written(self, seq: int) -> None:
        """Record a checkpoint after commit `seq`, made from the last snapshot."""
        self._checkpointed, self._changed_then = seq, self._changed_in_snapshot
