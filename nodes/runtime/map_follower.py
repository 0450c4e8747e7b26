"""Keeps a node's replica of the map up to date.

It subscribes first and fetches a snapshot afterwards. It fetches again after missed or abridged commits,
after a restart of the knowledge base that puts the replica in doubt, and after a change of relations without
a commit.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from concurrent.futures import Future
from typing import Any, Generic, NamedTuple, TypeVar

from semmap.nodes.runtime.loop import Node
from semmap.nodes.runtime.map_replica import MapReplica
from semmap.schemas import errors, keys
from semmap.schemas.calls import Call
from semmap.schemas.commands import Classes
from semmap.schemas.commits import Commit, Effects, Snapshot
from semmap.schemas.entities import ClassInfo
from semmap.schemas.health import Health

_LOOK_S = 0.2
_BEHIND_S = 3.0
"""If the knowledge base is behind the replica for this time, it never made the replica's last commits."""

C = TypeVar("C", Commit, Effects)


class SnapshotLoaded(NamedTuple):
    """A replica was loaded from a snapshot: its commit before (-1: none), the new commit, and the classes."""

    before: int
    seq: int
    classes: tuple[ClassInfo, ...]


class Follower(Generic[C]):
    """Keeps a replica up to date. Owned by the node's thread, like the replica."""

    def __init__(
        self,
        node: Node,
        replica: MapReplica[C],
        topic: keys.Topic,
        *,
        on_commit: Callable[[C, bool], None],
        on_snapshot: Callable[[SnapshotLoaded], None],
        classes_at: str = keys.BRIDGE,
    ) -> None:
        """Follow `topic`, which publishes commits in full or their effects.

        The class table is requested at `classes_at`: from the knowledge base or, for clients without access
        to it, as a command.

        `on_commit(commit, known)` is called after each commit; `known` means that the replica includes it.
        `on_snapshot(loaded)` is called after the replica was loaded from a snapshot.
        """
        self._node = node
        self._replica: MapReplica[C] = replica
        self._on_commit_taken: Callable[[C, bool], None] = on_commit
        self._on_snapshot = on_snapshot
        self._classes_at = classes_at
        self._fetching = False
        self._begun_ns = 0
        self._kb_started_ns = 0
        self._shapes_ns = self._requested_ns = 0
        self._is_outdated = False
        """Whether relations have changed since the map was last requested."""
        self._is_renewing = False
        """Whether the map is being fetched because relations have changed."""
        self._ahead: tuple[int, float] | None = None
        """A commit of the replica that the knowledge base did not have, and since when."""
        self._previous = -1
        """The last commit, as of the knowledge base's last heartbeat but one."""
        node.describe("waiting for the knowledge base")
        node.follow(topic, self._on_commit)
        node.follow(keys.HEALTH, self._on_health)
        node.every(_LOOK_S, self._check)

    def _on_commit(self, commit: C) -> None:
        known = self._replica.take(commit)
        self._on_commit_taken(commit, known)
        if not known or commit.tbox:
            self._fetch()

    def _on_health(self, health: Health) -> None:
        """Doubt the replica after a restart of the knowledge base, which may have another map."""
        if health.node != "kb_node":
            return
        self._follow_shapes(health)
        if health.started_ns == self._kb_started_ns:
            self._fetch_if_missed(health.commit)
            self._compare(health)
            return
        is_another = self._kb_started_ns or health.started_ns > self._begun_ns
        self._kb_started_ns = health.started_ns
        if self._replica.seq >= 0 and is_another:
            self._replica.doubt()
            self._fetch()

    def _follow_shapes(self, health: Health) -> None:
        """Fetch the map again if relations have changed since it was fetched."""
        before = self._shapes_ns if health.started_ns == self._kb_started_ns else self._requested_ns
        self._shapes_ns = health.shapes_ns
        if health.shapes_ns > before:
            self._is_outdated = True
            if self._replica.seq >= 0:
                self._fetch()

    def _compare(self, health: Health) -> None:
        """Compare the last commit of the knowledge base with that of the replica."""
        replica = self._replica
        if health.commit is None or replica.seq < 0:
            return
        replica.confirm(health.commit, health.digest)
        now_s = time.monotonic()
        if self._ahead is None or health.commit >= self._ahead[0]:
            self._ahead = (replica.seq, now_s) if replica.seq > health.commit else None
        elif now_s - self._ahead[1] > _BEHIND_S:
            self._ahead = None
            replica.doubt()

    def _fetch_if_missed(self, commit: int | None) -> None:
        """Fetch the map if a commit of an earlier heartbeat has not arrived.

        Not while it is being fetched, which takes several heartbeats for a large map.
        """
        missed = 0 <= self._replica.seq < self._previous and not self._replica.is_being_fetched
        self._previous = -1 if commit is None else commit
        if missed:
            self._fetch()

    def _check(self) -> None:
        is_old = self._is_outdated and self._replica.seq >= 0
        if (is_old or not self._replica.is_current) and not self._replica.is_being_fetched:
            self._fetch()

    def _fetch(self) -> None:
        """Request the class table, then a snapshot page by page; it is repeated after a failure."""
        if self._fetching:
            return
        self._fetching, self._requested_ns = True, time.time_ns()
        self._is_renewing, self._is_outdated = self._is_outdated, False
        pages = self._replica.begin_pages()
        classes: list[ClassInfo] = []

        def on_classes(rows: tuple[ClassInfo, ...]) -> None:
            classes.extend(rows)
            self._ask(pages.query, on_page)

        def on_page(page: Snapshot) -> None:
            if page.more:
                self._ask(pages.after(page), on_page)  # prepared while this one is processed
            pages.take(page)
            if page.more:
                return
            self._fetching = False
            self._begin(pages.snapshot, tuple(classes))

        self._ask(Classes(), on_classes, at=self._classes_at)

    def _abort(self) -> None:
        self._fetching = False
        self._is_outdated = self._is_outdated or self._is_renewing
        self._replica.cancel_pages()

    def _begin(self, snapshot: Snapshot, classes: tuple[ClassInfo, ...]) -> None:
        before = self._replica.seq
        if self._replica.begin(snapshot):
            self._begun_ns = time.time_ns()
            self._on_snapshot(SnapshotLoaded(before, snapshot.seq, classes))
            if self._is_outdated:
                self._fetch()
        elif self._is_renewing:
            self._is_outdated = True  # a commit has arrived that the snapshot does not have; see _check

    def _ask(self, call: Call[Any], take: Callable[[Any], None], *, at: str = keys.BRIDGE) -> None:
        def on_done(done: Future[Any]) -> None:
            try:
                take(done.result())
            except errors.NoAnswer:
                self._abort()
            except Exception as error:
                self._abort()
                self._node.report(f"cannot follow the map: {type(error).__name__}: {error}")

        self._node.ask_later(at, call).add_done_callback(on_done)
