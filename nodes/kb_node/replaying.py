"""Replays the commits of another journal into the map, in the rhythm in which they were made.

Nobody else changes such a map. A knowledge base that is restarted goes on where its own journal ends.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from concurrent.futures import Future
from pathlib import Path
from typing import Any, Final

from msgspec import structs

from nodes.kb_node.config import Replay
from nodes.kb_node.semantic_map import SemanticMap
from nodes.kb_node.storage.journal import Journal
from nodes.kb_node.storage.replay.preparing import SOURCE
from nodes.runtime import rhythm
from nodes.runtime.loop import Node
from schemas import errors, keys
from schemas.bridge import LoadDocument, LoadTBox, TakeBack, Transactions
from schemas.calls import Handler, by_verb
from schemas.commands import Compact, Status
from schemas.commits import Commit, Transaction
from schemas.replies import SystemStatus

_LOOK_S: Final = 0.3
_MOST_LOOKS: Final = 100
"""So often it is looked whether all others are ready; then the replay begins without them."""

CHANGES: Final = (Transaction, Transactions, LoadDocument, LoadTBox, TakeBack, Compact)


class Player:
    """Commits one commit after another, each when its time has come. Owned by the node's thread."""

    def __init__(
        self,
        node: Node,
        semantic_map: SemanticMap,
        data: Path,
        replay: Replay,
        spread: Callable[[Commit], None],
    ) -> None:
        """`data` is the folder of the replay; `spread(commit)` tells everybody of a new commit."""
        self._node = node
        self._map = semantic_map
        self._source = Journal(data / SOURCE)
        self._replay = replay
        self._spread = spread
        self._looks = 0
        node.later(_LOOK_S, self._look)

    def close(self) -> None:
        """Let go of the journal."""
        self._source.close()

    def describe(self) -> str:
        """How far it is, in words."""
        until, now = self._replay.until, self._map.seq
        return f"replayed up to commit {until}" if now >= until else f"replaying, at commit {now} of {until}"

    def _look(self) -> None:
        """Begin when all nodes are ready and the bodies stand."""
        self._looks += 1
        if self._looks > _MOST_LOOKS:
            self._schedule()
            return

        def told(done: Future[SystemStatus]) -> None:
            if done.exception() is None and self._are_ready(done.result()):
                self._schedule()
            else:
                self._node.later(_LOOK_S, self._look)

        self._node.ask_later(keys.CMD, Status()).add_done_callback(told)

    def _are_ready(self, status: SystemStatus) -> bool:
        ready = {node.node for node in status.nodes if node.state == "ready"}
        needs_bodies = "sim_node" in self._replay.nodes
        return ready >= {*self._replay.nodes} and (not needs_bodies or status.in_agreement is True)

    def _schedule(self) -> None:
        """Have the next commit made when its time has come."""
        now = self._map.seq
        if now >= self._replay.until:
            return
        stamps = self._source.stamps
        wait_s = (
            rhythm.wait_s(
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
        self._spread(self._map.restate(as_made, tbox))
        self._schedule()


def refusing() -> Mapping[str, Handler]:
    """Handlers for what would change a map that is replayed, by verb: each refuses."""

    def refuse(_: Any) -> Any:
        raise errors.Refused("this map is a replay of the past, and cannot be changed; change the map itself")

    return by_verb(*(Handler(kind, refuse) for kind in CHANGES))
