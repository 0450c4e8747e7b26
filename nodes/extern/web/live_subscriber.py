"""The subscriptions of the page's node to the map, the scene and the nodes.

They run on the thread of the node, and collect updates for the event loop of the page.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from concurrent.futures import Future
from typing import Final

from msgspec import Struct

from semmap.nodes.drawing.articulation import JointPositions, joint_positions_of
from semmap.nodes.drawing.scene_state import SceneState
from semmap.nodes.runtime.loop import Node
from semmap.nodes.runtime.map_follower import Follower, SnapshotLoaded
from semmap.nodes.runtime.map_replica import MapReplica
from semmap.schemas import keys
from semmap.schemas.bridge import CopyQuery, MapCopy
from semmap.schemas.commits import Commit
from semmap.schemas.entities import ClassInfo, Entity, Pose
from semmap.schemas.health import Health
from semmap.schemas.scenes import Point, Poses, Scene, SceneQuery

PERIOD_S: Final = 0.1
"""Minimum interval between two updates."""
_SILENT_S: Final = 3.5
"""Time without a heartbeat after which the knowledge base counts as lost; nodes send one per second."""
_SCENE_LOST_S: Final = 10.0


class LoadedMap(Struct, frozen=True, kw_only=True):
    """The whole map, read again."""

    map_id: str
    seq: int
    entities: dict[str, Entity]
    classes: tuple[ClassInfo, ...]


class LoadedScene(Struct, frozen=True, kw_only=True):
    """The scene after bodies were added or removed, or None without a simulator."""

    now: Scene | None


class Updates:
    """Updates since the last post; the thread of the node collects them."""

    def __init__(self) -> None:
        self.map: LoadedMap | None = None
        self.commits: list[Commit] = []
        self.scene: LoadedScene | None = None
        self.moved: dict[str, Pose] = {}
        self.joint_positions: dict[str, JointPositions] = {}
        self.drives: dict[str, tuple[Point, ...]] | None = None
        self.poses_received = 0
        self.health: dict[str, Health] = {}
        self.offline_reason: str | None = None
        """Why there is no connection; empty while there is one, None if that is unknown."""


class LiveSubscriber:
    """The subscriptions of the node to the map, the scene and the nodes.

    It runs on the thread of the node.
    """

    def __init__(self, node: Node, post: Callable[[Updates], None], *, secure: bool) -> None:
        self._node = node
        self._post = post
        self._updates = Updates()
        self._is_due = False
        self._replica = MapReplica[Commit]()
        self._map_id = ""
        self._classes: tuple[ClassInfo, ...] = ()
        self._has_map = False
        """Whether the whole map was posted, so that single commits can follow."""
        self._scene = SceneState()
        self._drives: dict[str, tuple[Point, ...]] = {}
        self._fetching_scene = False
        self._poses_s = 0.0
        self._kb_s = 0.0
        self._posted_s = 0.0
        classes_at = keys.CMD if secure else keys.BRIDGE
        Follower(
            node,
            self._replica,
            keys.COMMIT,
            on_commit=self._on_commit,
            on_snapshot=self._on_map,
            classes_at=classes_at,
        )
        node.follow(keys.HEALTH, self._on_health)
        node.follow_newest(keys.POSES, self._on_poses)
        node.every(0.5, self._check_liveliness)

    def _schedule(self) -> None:
        """Post the updates now, or as soon as the minimum interval has passed."""
        if not self._is_due:
            self._is_due = True
            self._node.later(self._posted_s + PERIOD_S - time.monotonic(), self._flush)

    def _flush(self) -> None:
        self._is_due, self._posted_s = False, time.monotonic()
        updates, self._updates = self._updates, Updates()
        self._post(updates)

    # The map

    def _on_commit(self, commit: Commit, known: bool) -> None:
        if known and self._has_map:
            self._updates.commits.append(commit)
            self._schedule()

    def _on_map(self, begun: SnapshotLoaded) -> None:
        """Request the id of the map, and post the map when it is known."""
        self._has_map, self._classes = False, begun.classes
        self._updates.commits.clear()

        def on_copy(future: Future[MapCopy]) -> None:
            if future.exception() is None:
                self._map_id = future.result().map_id
            self._post_map()

        self._node.ask_later(keys.BRIDGE, CopyQuery(content=False)).add_done_callback(on_copy)

    def _post_map(self) -> None:
        self._has_map = True
        self._updates.commits.clear()
        self._updates.map = LoadedMap(
            map_id=self._map_id,
            seq=self._replica.seq,
            entities=dict(self._replica.entities),
            classes=self._classes,
        )
        self._check_liveliness()

    # The nodes

    def _on_health(self, health: Health) -> None:
        if health.node == "kb_node":
            self._kb_s = time.monotonic()
        self._updates.health[health.node] = health
        self._schedule()

    def _check_liveliness(self) -> None:
        self._updates.offline_reason = self._offline_reason()
        self._schedule()
        if self._scene.known and time.monotonic() - self._poses_s > _SCENE_LOST_S:
            self._scene = SceneState()
            self._updates.drives = self._drives = {}
            self._updates.scene, self._updates.moved = LoadedScene(now=None), {}
            self._updates.joint_positions.clear()

    def _offline_reason(self) -> str:
        if time.monotonic() - self._kb_s > _SILENT_S:
            if self._kb_s:
                return "no response from the knowledge base; the page continues when it is back"
            return "no knowledge base found; start a system with `semmap up`"
        return "" if self._has_map else "reading the map"

    # The scene

    def _on_poses(self, poses: Poses) -> None:
        self._poses_s = time.monotonic()
        self._updates.poses_received += 1
        if poses.drives != self._drives:
            self._updates.drives = self._drives = poses.drives
            self._schedule()
        if not self._scene.matches(poses):
            self._fetch_scene()
            return
        if problem := self._scene.find_problem(poses):
            self._node.drop(f"poses dropped: {problem}")
            return
        moved = dict(self._scene.follow(poses))
        if moved:
            self._updates.moved.update(moved)
            bodies = (self._scene.bodies[name] for name in moved)
            self._updates.joint_positions.update(
                (body.name, joint_positions_of(body.joints)) for body in bodies if body.joints
            )
            self._schedule()

    def _fetch_scene(self) -> None:
        if self._fetching_scene:
            return
        self._fetching_scene = True

        def on_scene(future: Future[Scene]) -> None:
            self._fetching_scene = False
            if future.exception() is None:
                self._scene.take(future.result())
                self._updates.scene, self._updates.moved = LoadedScene(now=future.result()), {}
                self._updates.joint_positions.clear()
                self._schedule()

        self._node.ask_later(keys.SIM, SceneQuery()).add_done_callback(on_scene)
