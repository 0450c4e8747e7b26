"""When the whole map is to be written down, so that the next start has little to replay."""

from __future__ import annotations

from collections.abc import Sized
from typing import Final

from semmap.nodes.kb_node.storage.journal import Journal
from semmap.schemas.commits import Commit

CHECKPOINT_EVERY: Final = 5000
"""Commits, in a quiet moment."""
CHECKPOINT_AT_LATEST: Final = 20_000
CHECKPOINT_EVERY_TRIPLES: Final = 100_000
"""Triples that changed; at once if they are half of the map."""


class CheckpointSchedule:
    """Counts what has changed since the last checkpoint."""

    def __init__(self, journal: Journal, checkpointed: int) -> None:
        """`checkpointed` is the last commit of the newest checkpoint."""
        self._journal = journal
        self._checkpointed = checkpointed
        self._changed = self._changed_then = 0
        """Triples that changed, and those of them that are in the checkpoint."""
        self._changed_in_snapshot = 0

    def count(self, commit: Commit) -> None:
        """There is one more commit, or one that was there has been taken back."""
        self._changed += len(commit.inserted) + len(commit.retracted)

    def is_due(self, seq: int, *, quiet: bool) -> bool:
        """Would a start after commit `seq` have much to replay? Unless it is `quiet`, very much?

        Another TBox is much.
        """
        if quiet and self._changed - self._changed_then > CHECKPOINT_EVERY_TRIPLES:
            return True
        if quiet and self._journal.tbox_changes(after=self._checkpointed):
            return True
        return seq - self._checkpointed >= (CHECKPOINT_EVERY if quiet else CHECKPOINT_AT_LATEST)

    def is_urgent(self, triples: Sized) -> bool:
        """Would the next start have to replay most of a map of these triples?"""
        changed = self._changed - self._changed_then
        return changed > CHECKPOINT_EVERY_TRIPLES and 2 * changed >= len(triples)

    def is_written(self, seq: int) -> bool:
        """Is there a checkpoint of the map after commit `seq`?"""
        return seq == self._checkpointed

    def mark_snapshot(self) -> None:
        """The picture is taken that the next checkpoint is made of."""
        self._changed_in_snapshot = self._changed

    def mark_written(self, seq: int) -> None:
        """There is a checkpoint of the map after commit `seq`, made of the last picture."""
        self._checkpointed, self._changed_then = seq, self._changed_in_snapshot
