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
from concurrent.futures import ThreadPoolExecutor
from types import MappingProxyType
from typing import Any, Final, Literal, TypeVar

from msgspec import Struct

from semmap.nodes import bus
from semmap.nodes.drawing.articulation import JointPositions, joint_positions_of
from semmap.nodes.extern.client import Client
from semmap.nodes.extern.sparql_client import StandingQuery
from semmap.nodes.extern.web.live_subscriber import LiveSubscriber, LoadedMap, Updates
from semmap.nodes.extern.web.loads import measure_loads
from semmap.nodes.extern.web.views.system_status import RateHistory
from semmap.nodes.identity import Identity
from semmap.nodes.runtime.loop import Node
from semmap.schemas import keys, roles
from semmap.schemas.calls import Call
from semmap.schemas.commands import Command
from semmap.schemas.commits import Commit
from semmap.schemas.entities import ClassInfo, Entity, Pose
from semmap.schemas.health import Health
from semmap.schemas.scenes import Point, Scene

Kind = Literal["commit", "poses", "drives", "scene", "reset", "connection", "health"]

TIMEOUT_S: Final = 10.0
_PARALLEL_REQUESTS: Final = 16

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
        self._subscriber = LiveSubscriber(self._node, self._post, secure=identity is not None)
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

    def _post(self, updates: Updates) -> None:
        """Post updates from the thread of the node to the event loop."""
        loop = self._loop
        if loop is not None:
            with contextlib.suppress(RuntimeError):  # the loop has ended
                loop.call_soon_threadsafe(self._deliver, updates)

    def _deliver(self, updates: Updates) -> None:
        for event in self._apply(updates):
            for listener in tuple(self._listeners):
                listener(event)

    def _apply(self, updates: Updates) -> Iterator[LiveEvent]:
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

    def _reset(self, read: LoadedMap) -> LiveEvent:
        is_another = bool(self.map_id) and read.map_id != self.map_id
        self.loads += 1
        self._entities.clear()
        self._entities.update(read.entities)
        self.classes, self.commit, self.map_id = read.classes, read.seq, read.map_id
        return LiveEvent(kind="reset", is_new_map=is_another)
