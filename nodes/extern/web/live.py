"""The current state of the map, the scene and the nodes in the process of the page.

A node subscribes to them on its own thread, and posts updates to the event loop of the page at most ten times
a second. The event loop owns all attributes of `Live`, and never waits for the system.
"""

from __future__ import annotations

import asyncio
import contextlib
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from types import MappingProxyType
from typing import Any, Final, Literal, TypeVar

from msgspec import Struct

from semmap.nodes import bus
from semmap.nodes.drawing.articulation import JointPositions, joint_positions_of
from semmap.nodes.drawing.scene_state import SceneState
from semmap.nodes.extern.client import Client
from semmap.nodes.extern.sparql_client import StandingQuery
from semmap.nodes.extern.web.loads import measure_loads
from semmap.nodes.extern.web.views.system_status import RateHistory
from semmap.nodes.identity import Identity
from semmap.nodes.runtime.loop import Node
from semmap.nodes.runtime.map_follower import Follower, SnapshotLoaded
from semmap.nodes.runtime.map_replica import MapReplica
from semmap.schemas import keys, roles
from semmap.schemas.bridge import CopyQuery, MapCopy
from semmap.schemas.calls import Call
from semmap.schemas.commands import Command
from semmap.schemas.commits import Commit
from semmap.schemas.entities import ClassInfo, Entity, Pose
from semmap.schemas.health import Health
from semmap.schemas.scenes import Point, Poses, Scene, SceneQuery

Kind = Literal["commit", "poses", "drives", "scene", "reset", "connection", "health"]

PERIOD_S: Final = 0.1
"""Minimum interval between two updates."""
TIMEOUT_S: Final = 10.0
_PARALLEL_REQUESTS: Final = 16
_SILENT_S: Final = 3.5
"""Time without a heartbeat after which the knowledge base counts as lost; nodes send one per second."""
_SCENE_LOST_S: Final = 10.0

R = TypeVar("R")


class LiveEvent(Struct, frozen=True, kw_only=True):
    """An update of `Live`, sent after its attributes have changed.

    - `commit`: `commits` were applied, in order
    - `poses`: the bodies `names` moved
    - `drives`: robots began, continued or ended a drive
    - `scene`: bodies were added or removed, or became ghosts or solid
    - `reset`: the whole map was read again; `is_new_map` if it is another map
    - `connection`: the connection to the knowledge base was lost or restored
    - `health`: the nodes `names` sent heartbeats
    """

    kind: Kind
    commits: tuple[Commit, ...] = ()
    names: tuple[str, ...] = ()
    is_new_map: bool = False


Listener = Callable[[LiveEvent], None]


class Live:
    """The current state of the system; it belongs to the event loop on which `start` was called."""

    def __init__(self, session: bus.Session, network: bus.Network, identity: Identity | None = None) -> None:
        """`session` is open with `network`; the caller closes it after `stop`."""
        self.identity = identity
        self.session = session
        self.commit = -1
        """The last applied commit; -1 before the map is known."""
        self.map_id = ""
        """The id of the map; a new map has another one."""
        self.loads = 0
        """The number of times that the whole map was read."""
        self.connected = False
        self.offline_reason = "reading the map"
        """Why there is no connection; empty while there is one."""
        self.classes: tuple[ClassInfo, ...] = ()
        self.scene: Scene | None = None
        """The scene when bodies were last added or removed; `poses` has their current poses."""
        self.health: dict[str, Health] = {}
        """The last heartbeat of each node."""
        self.rates = RateHistory()
        """The load of the system over the last ten minutes."""
        self._poses_received = 0
        self._entities: dict[str, Entity] = {}
        self._poses: dict[str, Pose] = {}
        self._joint_positions: dict[str, JointPositions] = {}
        self.entities: Mapping[str, Entity] = MappingProxyType(self._entities)
        self.poses: Mapping[str, Pose] = MappingProxyType(self._poses)
        self.joint_positions: Mapping[str, JointPositions] = MappingProxyType(self._joint_positions)
        """The joints that are not at 0, and their positions, by body."""
        self.drives: Mapping[str, tuple[Point, ...]] = {}
        """The points that driving robots still have to reach, by robot."""
        self._listeners: list[Listener] = []
        self._loop: asyncio.AbstractEventLoop | None = None
        self._threads = ThreadPoolExecutor(_PARALLEL_REQUESTS, thread_name_prefix="request")
        self._client = Client(session, agent="web", identity=identity)
        self._node = Node(keys.WEB, session, network.commands)
        self._subscriber = _Subscriber(self._node, self._post, secure=identity is not None)
        self._thread = threading.Thread(target=self._node.run, name="live", daemon=True)

    # On the event loop

    @property
    def places(self) -> Mapping[str, Entity]:
        """The places among the entities, by name."""
        return {name: entity for name, entity in self._entities.items() if entity.place}

    def start(self) -> None:
        """Start receiving updates; to be called on the event loop that owns this object from then on."""
        self._loop = asyncio.get_running_loop()
        self._thread.start()

    def ready(self, detail: str) -> None:
        """Report to the supervisor that the page can be opened."""
        self._node.soon(lambda: self._node.ready(detail))

    def stop(self) -> None:
        """Stop receiving updates, without waiting for open requests."""
        self._loop = None
        self._node.stop()
        self._threads.shutdown(wait=False, cancel_futures=True)

    def listen(self, listener: Listener) -> Callable[[], None]:
        """Call `listener` with every update; return a function that stops this."""
        self._listeners.append(listener)

        def stop() -> None:
            with contextlib.suppress(ValueError):
                self._listeners.remove(listener)

        return stop

    def is_allowed(self, command: str) -> bool:
        """Return whether the role of this page may send a command; without certificates it may send all."""
        return self.identity is None or self.identity.role in roles.COMMANDS.get(command, frozenset())

    async def ask(self, command: Command[R], timeout_s: float = TIMEOUT_S) -> R:
        """Send a command and return its reply, without blocking the event loop. Raises as `Client.send`."""
        return await self._run_in_thread(lambda: self._client.send(command, timeout_s=timeout_s))

    async def query(self, prefix: str, call: Call[R], timeout_s: float = TIMEOUT_S) -> R:
        """Send a request to a node at `prefix/<verb>`, such as `query(keys.SIM, SurfaceQuery(...))`.

        Raises the error of the reply, or NoAnswer if the node is not there or the role may not query it.
        """
        return await self._run_in_thread(lambda: self._node.ask(prefix, call, timeout_s=timeout_s))

    def follow(self, topic: keys.Topic, listener: Callable[[str, Any], None]) -> Callable[[], None]:
        """Call `listener(key, message)` on the event loop for each message.

        Return a function that stops this.
        """
        loop = asyncio.get_running_loop()

        def receive(key: str, message: Any) -> None:
            with contextlib.suppress(RuntimeError):  # the loop has ended
                loop.call_soon_threadsafe(listener, key, message)

        subscriber = bus.follow(self.session, topic, receive)
        return lambda: subscriber.undeclare()

    async def watch(self, query: str, *, inferred: bool) -> tuple[StandingQuery, Callable[[], None]]:
        """Start a standing query.

        Return it and a function that ends it and waits. Raises as `Client.watch`.
        """

        def begin() -> tuple[StandingQuery, Callable[[], None]]:
            stack = contextlib.ExitStack()
            return stack.enter_context(self._client.watch(query, inferred=inferred)), stack.close

        return await self._run_in_thread(begin)

    async def _run_in_thread(self, function: Callable[[], R]) -> R:
        return await asyncio.get_running_loop().run_in_executor(self._threads, function)

    # From the node's thread to the event loop

    def _post(self, updates: _Updates) -> None:
        """Post updates from the thread of the node to the event loop."""
        loop = self._loop
        if loop is not None:
            with contextlib.suppress(RuntimeError):  # the loop has ended
                loop.call_soon_threadsafe(self._deliver, updates)

    def _deliver(self, updates: _Updates) -> None:
        for event in self._apply(updates):
            for listener in tuple(self._listeners):
                listener(event)

    def _apply(self, updates: _Updates) -> Iterator[LiveEvent]:
        """Apply the updates, and yield an event for each kind of change."""
        if updates.map is not None:
            yield self._reset(updates.map)
        if commits := tuple(commit for commit in updates.commits if commit.seq > self.commit):
            for commit in commits:
                for removed in commit.removed:
                    self._entities.pop(removed.name, None)
                self._entities.update((entity.name, entity) for entity in commit.changed)
            self.commit = commits[-1].seq
            yield LiveEvent(kind="commit", commits=commits)
        if updates.scene is not None:
            self.scene = updates.scene.now
            self._poses.clear()
            self._joint_positions.clear()
            if self.scene is not None:
                self._poses.update((body.name, body.pose) for body in self.scene.bodies)
                self._joint_positions.update(
                    (body.name, joint_positions_of(body.joints)) for body in self.scene.bodies if body.joints
                )
            yield LiveEvent(kind="scene")
        self._poses_received += updates.poses_received
        if updates.moved:
            self._poses.update(updates.moved)
            self._joint_positions.update(updates.joint_positions)
            yield LiveEvent(kind="poses", names=tuple(updates.moved))
        if updates.drives is not None and updates.drives != self.drives:
            self.drives = updates.drives
            yield LiveEvent(kind="drives", names=tuple(updates.drives))
        if updates.offline_reason is not None and (self.connected, self.offline_reason) != (
            not updates.offline_reason,
            updates.offline_reason,
        ):
            self.connected, self.offline_reason = not updates.offline_reason, updates.offline_reason
            yield LiveEvent(kind="connection")
        if updates.health:
            self.health.update(updates.health)
            self._sample()
            yield LiveEvent(kind="health", names=tuple(updates.health))

    def _sample(self) -> None:
        now_s = time.time()
        if self.rates.is_due(now_s):
            loads = measure_loads(self.health.values())
            self.rates.add_sample(now_s, self.commit, self._poses_received, loads)

    def _reset(self, read: _Map) -> LiveEvent:
        is_another = bool(self.map_id) and read.map_id != self.map_id
        self.loads += 1
        self._entities.clear()
        self._entities.update(read.entities)
        self.classes, self.commit, self.map_id = read.classes, read.seq, read.map_id
        return LiveEvent(kind="reset", is_new_map=is_another)


class _Map(Struct, frozen=True, kw_only=True):
    map_id: str
    seq: int
    entities: dict[str, Entity]
    classes: tuple[ClassInfo, ...]


class _Bodies(Struct, frozen=True, kw_only=True):
    now: Scene | None


class _Updates:
    """Updates since the last post; the thread of the node collects them."""

    def __init__(self) -> None:
        self.map: _Map | None = None
        self.commits: list[Commit] = []
        self.scene: _Bodies | None = None
        self.moved: dict[str, Pose] = {}
        self.joint_positions: dict[str, JointPositions] = {}
        self.drives: dict[str, tuple[Point, ...]] | None = None
        self.poses_received = 0
        self.health: dict[str, Health] = {}
        self.offline_reason: str | None = None
        """Why there is no connection; empty while there is one, None if that is unknown."""


class _Subscriber:
    """The subscriptions of the node to the map, the scene and the nodes.

    It runs on the thread of the node.
    """

    def __init__(self, node: Node, post: Callable[[_Updates], None], *, secure: bool) -> None:
        self._node = node
        self._post = post
        self._updates = _Updates()
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
        updates, self._updates = self._updates, _Updates()
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
        self._updates.map = _Map(
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
            self._updates.scene, self._updates.moved = _Bodies(now=None), {}
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
                self._updates.scene, self._updates.moved = _Bodies(now=future.result()), {}
                self._updates.joint_positions.clear()
                self._schedule()

        self._node.ask_later(keys.SIM, SceneQuery()).add_done_callback(on_scene)
