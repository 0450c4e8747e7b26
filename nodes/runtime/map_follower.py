"""Following the map: the one way in which nodes keep a replica of it up to date.

Subscribe first, then fetch; whatever is missed, abridged or doubted after a restart of the knowledge base is
fetched again.
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
"""A knowledge base that is behind the replica for so long never made what the replica is ahead by."""

C = TypeVar("C", Commit, Effects)


class SnapshotLoaded(NamedTuple):
    """A replica was begun anew: the commit it was at before (-1: none), that of the snapshot, the classes."""

    before: int
    seq: int
    classes: tuple[ClassInfo, ...]


class Follower(Generic[C]):
    """Keeps a replica fresh. Owned by the node's thread, as the replica is."""

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

        The class table is asked for at `classes_at`: of the knowledge base, or, by who may not ask that, as a
        command.

        `on_commit(commit, known)` is called after each commit; `known`: the replica is at it or beyond.
        `on_snapshot(what)` is called after each snapshot that the replica has begun with.
        """
        self._node = node
        self._replica: MapReplica[C] = replica
        self._on_commit_taken: Callable[[C, bool], None] = on_commit
        self._on_snapshot = on_snapshot
        self._classes_at = classes_at
        self._fetching = False
        self._begun_ns = 0
        self._kb_started_ns = 0
        self._ahead: tuple[int, float] | None = None
        """A commit that the replica has and the knowledge base had not, and since when."""
        self._there = -1
        """The last commit, as of the knowledge base's last beat but one."""
        node.describe("waiting for the knowledge base")
        node.follow(topic, self._on_commit)
        node.follow(keys.HEALTH, self._on_health)
        node.every(_LOOK_S, self._look)

    def _on_commit(self, commit: C) -> None:
        known = self._replica.take(commit)
        self._on_commit_taken(commit, known)
        if not known or commit.tbox:
            self._fetch()

    def _on_health(self, health: Health) -> None:
        """Another process of the knowledge base may know another map, or less of the same."""
        if health.node != "kb_node":
            return
        if health.started_ns == self._kb_started_ns:
            self._notice(health.commit)
            self._compare(health)
            return
        is_another = self._kb_started_ns or health.started_ns > self._begun_ns
        self._kb_started_ns = health.started_ns
        if self._replica.seq >= 0 and is_another:
            self._replica.doubt()
            self._fetch()

    def _compare(self, health: Health) -> None:
        """What the knowledge base says of its last commit, with what was heard of it."""
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

    def _notice(self, commit: int | None) -> None:
        """What the knowledge base had at its last beat and is not here by now has been missed.

        Unless somebody is fetching it just now, which takes several beats of a large map.
        """
        missed = 0 <= self._replica.seq < self._there and not self._replica.is_being_fetched
        self._there = -1 if commit is None else commit
        if missed:
            self._fetch()

    def _look(self) -> None:
        if not self._replica.is_current and not self._replica.is_being_fetched:
            self._fetch()

    def _fetch(self) -> None:
        """Ask for the class table, then for a snapshot page by page; it is asked again after a failure."""
        if self._fetching:
            return
        self._fetching = True
        pages = self._replica.begin_pages()
        classes: list[ClassInfo] = []

        def on_classes(rows: tuple[ClassInfo, ...]) -> None:
            classes.extend(rows)
            self._ask(pages.query, on_page)

        def on_page(page: Snapshot) -> None:
            if page.more:
                self._ask(pages.after(page), on_page)  # made while this one is taken
            pages.take(page)
            if page.more:
                return
            self._fetching = False
            self._begin(pages.snapshot, tuple(classes))

        self._ask(Classes(), on_classes, at=self._classes_at)

    def _give_up(self) -> None:
        self._fetching = False
        self._replica.give_up_pages()

    def _begin(self, snapshot: Snapshot, classes: tuple[ClassInfo, ...]) -> None:
        before = self._replica.seq
        if self._replica.begin(snapshot):
            self._begun_ns = time.time_ns()
            self._on_snapshot(SnapshotLoaded(before, snapshot.seq, classes))

    def _ask(self, call: Call[Any], take: Callable[[Any], None], *, at: str = keys.BRIDGE) -> None:
        def on_done(done: Future[Any]) -> None:
            try:
                take(done.result())
            except errors.NoAnswer:
                self._give_up()
            except Exception as error:
                self._give_up()
                self._node.report(f"cannot follow the map: {type(error).__name__}: {error}")

        self._node.ask_later(at, call).add_done_callback(on_done)
