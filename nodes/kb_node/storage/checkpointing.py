"""Checkpoints, which limit what the next start must replay: their schedule, and writing in the background."""

from __future__ import annotations

from collections.abc import Callable, Sized
from concurrent.futures import Future, ThreadPoolExecutor
from typing import TYPE_CHECKING, Final

from semmap.nodes.kb_node.storage.journal import Journal
from semmap.nodes.runtime import memory
from semmap.schemas.commits import Commit

if TYPE_CHECKING:
    from semmap.nodes.kb_node.semantic_map import SemanticMap

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


class Checkpointing:
    """Writes one checkpoint at a time while the map keeps changing."""

    def __init__(
        self, semantic_map: SemanticMap, journal: Journal, soon: Callable[[Callable[[], None]], None]
    ) -> None:
        """Write checkpoints of `semantic_map`; `soon(handle)` calls `handle()` on the map's own thread."""
        self._map = semantic_map
        self._journal = journal
        self._soon = soon
        self._executor = ThreadPoolExecutor(max_workers=1, thread_name_prefix="checkpoint")
        self._writing: Future[int] | None = None
        """While a checkpoint is written: the number of its last commit."""
        self._seq_then = 0

    def begin_if_due(self) -> None:
        """Begin a checkpoint if it is due. In a quiet time it is due sooner."""
        quiet, self._seq_then = self._map.seq == self._seq_then, self._map.seq
        if self._map.checkpoint_is_due(quiet=quiet):
            self._begin()

    def begin_if_urgent(self) -> None:
        """Begin a checkpoint if the next start would have to replay most of the map."""
        if self._map.checkpoint_is_urgent:
            self._begin()

    def close(self) -> None:
        """Write a checkpoint for a quick start, unless that takes long. Raises Refused if it fails."""
        if self._writing is not None:
            self._map.written(self._writing.result())
        if not self._map.is_large or self._map.checkpoint_is_due(quiet=True):
            self._map.checkpoint()

    def _begin(self) -> None:
        if self._writing is not None:
            return
        snapshot = self._map.snapshot_for_checkpoint()

        def write() -> int:
            self._journal.checkpoint(snapshot)
            return snapshot.seq

        def end(done: Future[int]) -> None:
            self._writing = None
            memory.trim()
            self._map.written(done.result())

        self._writing = self._executor.submit(write)
        self._writing.add_done_callback(lambda done: self._soon(lambda: end(done)))
