"""Writes checkpoints of the map in the background, so that the next start is quick."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor

from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.storage.journal import Journal
from semmap.nodes.runtime import heap


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
            heap.trim()
            self._map.written(done.result())

        self._writing = self._executor.submit(write)
        self._writing.add_done_callback(lambda done: self._soon(lambda: end(done)))
