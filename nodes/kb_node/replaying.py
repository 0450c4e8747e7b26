"""Replays the commits of another journal into the map with their original timing.

No client can change such a map. After a restart the replay continues where the node's own journal ends.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from concurrent.futures import Future
from pathlib import Path
from typing import Any, Final

from msgspec import structs

from semmap.nodes.kb_node.config import Replay
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.storage.journal import Journal
from semmap.nodes.kb_node.storage.replay.preparation import SOURCE
from semmap.nodes.runtime import playback_clock
from semmap.nodes.runtime.loop import Node
from semmap.schemas import errors, keys
from semmap.schemas.bridge import LoadDocument, LoadTBox, TakeBack, Transactions
from semmap.schemas.calls import Handler, by_verb
from semmap.schemas.commands import Compact, Status
from semmap.schemas.commits import Commit, Transaction
from semmap.schemas.replies import SystemStatus

_CHECK_PERIOD_S: Final = 0.3
_MAX_CHECKS: Final = 100
"""Checks whether all other nodes are ready; after that many the replay begins without them."""

CHANGES: Final = (Transaction, Transactions, LoadDocument, LoadTBox, TakeBack, Compact)


class ReplayPlayer:
    """Commits one commit after another, each at its time. Owned by the node's thread."""

    def __init__(
        self,
        node: Node,
        semantic_map: SemanticMap,
        data: Path,
        replay: Replay,
        publish: Callable[[Commit], None],
    ) -> None:
        """Replay from the folder `data`; `publish(commit)` publishes a new commit."""
        self._node = node
        self._map = semantic_map
        self._source = Journal(data / SOURCE)
        self._replay = replay
        self._publish = publish
        self._checks = 0
        self._waits_for: tuple[str, ...] = ()
        node.later(_CHECK_PERIOD_S, self._check_ready)

    def close(self) -> None:
        """Close the source journal."""
        self._source.close()

    def describe(self) -> str:
        """Return the progress as text."""
        until, now = self._replay.until, self._map.seq
        return f"replayed up to commit {until}" if now >= until else f"replaying, at commit {now} of {until}"

    def _check_ready(self) -> None:
        """Begin when all nodes are ready and every entity has its body."""
        self._checks += 1
        if self._checks > _MAX_CHECKS:
            self._node.report(f"the replay starts before all nodes are ready: {'; '.join(self._waits_for)}")
            self._schedule()
            return

        def on_status(done: Future[SystemStatus]) -> None:
            failed = done.exception()
            self._waits_for = (str(failed),) if failed else find_missing(done.result(), self._replay.nodes)
            if self._waits_for:
                self._node.later(_CHECK_PERIOD_S, self._check_ready)
            else:
                self._schedule()

        self._node.ask_later(keys.CMD, Status()).add_done_callback(on_status)

    def _schedule(self) -> None:
        """Schedule the next commit."""
        now = self._map.seq
        if now >= self._replay.until:
            return
        stamps = self._source.stamps
        wait_s = (
            playback_clock.wait_s(
                stamps.of(now), stamps.of(now + 1), speed=self._replay.speed, longest_s=self._replay.longest_s
            )
            if now > self._source.beginning.seq
            else 0.0
        )
        self._node.later(wait_s, self._next)

    def _next(self) -> None:
        commit = self._source.commit(self._map.seq + 1)
        tbox = self._source.tbox(commit.seq) if commit.tbox else None
        as_made = structs.replace(commit, changed=(), removed=(), digest="")
        self._publish(self._map.restate(as_made, tbox))
        self._schedule()


def find_missing(status: SystemStatus, nodes: Collection[str]) -> tuple[str, ...]:
    """Return the conditions that a replay with these nodes still waits for, as sentences.

    The replay waits until every entity has its body. It does not wait for bodies that move or stand
    elsewhere.
    """
    ready = {node.node for node in status.nodes if node.state == "ready"}
    absent = tuple(f"{node} is not ready" for node in nodes if node not in ready)
    if absent or "sim_node" not in nodes:
        return absent
    return ("the scene is not known yet",) if status.in_agreement is None else status.pending


def rejecting_handlers() -> Mapping[str, Handler]:
    """Return handlers by command that reject changes of a replayed map."""

    def refuse(_: Any) -> Any:
        raise errors.Refused("this map is a replay and cannot be changed; change the original map")

    return by_verb(*(Handler(kind, refuse) for kind in CHANGES))
