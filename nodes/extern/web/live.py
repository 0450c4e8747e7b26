"""What the page's process knows of the map, the scene and the nodes, as they are now.

A node of its own follows them on a thread of its own; what is new it hands over to the event loop of the
page: at once after a pause, and at most ten times a second. The event loop owns all that `Live` shows,
and never waits for the system.
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
from semmap.nodes.drawing.bending import Bends, bends_of
from semmap.nodes.drawing.scene_state import SceneState
from semmap.nodes.extern.client import Client
from semmap.nodes.extern.sparql_client import StandingQuery
from semmap.nodes.extern.web.loads import loads_of
from semmap.nodes.extern.web.views.rates import Rates
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
from semmap.schemas.scenes import Poses, Scene, SceneQuery

Kind = Literal["commit", "poses", "scene", "begun", "connection", "health"]

PERIOD_S: Final = 0.1
"""What is new is told this often at most."""
TIMEOUT_S: Final = 10.0
_ASKED_AT_ONCE: Final = 16
_SILENT_S: Final = 3.5
"""A knowledge base that says nothing for so long does not answer: hearts beat once a second."""
_SCENE_LOST_S: Final = 10.0

R = TypeVar("R")


class Happening(Struct, frozen=True, kw_only=True):
    """What is new. The state of `Live` has changed already when it is told.

    `commit`: `commits` were made, in order. `poses`: the bodies `names` have moved. `scene`: bodies came,
    went or became ghosts. `begun`: everything was read anew; `anew` when it is another map than before.
    `connection`: the knowledge base has gone, or is back. `health`: a node's heart has beaten.
    """

    kind: Kind
    commits: tuple[Commit, ...] = ()
    names: tuple[str, ...] = ()
    anew: bool = False


Told = Callable[[Happening], None]


class Live:
    """The system as it is now; all of it belongs to the event loop that `start` was called on."""

    def __init__(self, session: bus.Session, network: bus.Network, identity: Identity | None = None) -> None:
        """`session` is open with `network`, and is closed by whoever opened it, after `stop`."""
        self.identity = identity
        self.session = session
        self.commit = -1
        """The last commit that is shown; -1 before the map is known."""
        self.map_id = ""
        """Which map it is: one that is begun anew has another."""
        self.connected = False
        self.why_not = "the map is being read"
        """While it is not connected: a sentence that says why."""
        self.classes: tuple[ClassInfo, ...] = ()
        self.scene: Scene | None = None
        """The bodies as they were when bodies last came or went; `poses` says where they are now."""
        self.health: dict[str, Health] = {}
        """The last heartbeat of each node."""
        self.rates = Rates()
        """How busy the system has been over the last ten minutes."""
        self._poses_heard = 0
        self._entities: dict[str, Entity] = {}
        self._poses: dict[str, Pose] = {}
        self._bends: dict[str, Bends] = {}
        self.entities: Mapping[str, Entity] = MappingProxyType(self._entities)
        self.poses: Mapping[str, Pose] = MappingProxyType(self._poses)
        self.bends: Mapping[str, Bends] = MappingProxyType(self._bends)
        """Of bodies with joints: which are not at 0, and where."""
        self._told: list[Told] = []
        self._loop: asyncio.AbstractEventLoop | None = None
        self._threads = ThreadPoolExecutor(_ASKED_AT_ONCE, thread_name_prefix="ask")
        self._client = Client(session, agent="web", identity=identity)
        self._node = Node(keys.WEB, session, network.commands)
        self._following = _Following(self._node, self._hand_over, secure=identity is not None)
        self._thread = threading.Thread(target=self._node.run, name="live", daemon=True)

    # Of the event loop

    @property
    def places(self) -> Mapping[str, Entity]:
        """The places among the entities, by name."""
        return {name: entity for name, entity in self._entities.items() if entity.place}

    def start(self) -> None:
        """Begin to follow; to be called on the event loop that owns this from then on."""
        self._loop = asyncio.get_running_loop()
        self._thread.start()

    def ready(self, detail: str) -> None:
        """Tell whoever has started this process that the page can be opened."""
        self._node.soon(lambda: self._node.ready(detail))

    def stop(self) -> None:
        """Follow no more, and wait for nobody."""
        self._loop = None
        self._node.stop()
        self._threads.shutdown(wait=False, cancel_futures=True)

    def listen(self, told: Told) -> Callable[[], None]:
        """Call `told` with everything that happens from now on; what is returned ends that."""
        self._told.append(told)

        def stop() -> None:
            with contextlib.suppress(ValueError):
                self._told.remove(told)

        return stop

    def may(self, verb: str) -> bool:
        """May whoever this page acts for ask for this command? Without certificates everybody may."""
        return self.identity is None or self.identity.role in roles.COMMANDS.get(verb, frozenset())

    async def ask(self, command: Command[R], timeout_s: float = TIMEOUT_S) -> R:
        """Send a command, and wait for its reply beside the event loop. Raises as `Client.send`."""
        return await self._beside(lambda: self._client.send(command, timeout_s=timeout_s))

    async def query(self, prefix: str, call: Call[R], timeout_s: float = TIMEOUT_S) -> R:
        """Ask a node itself, at `prefix/<verb>`, what is no command: `query(keys.SIM, SurfaceQuery(...))`.

        Raises as the node answers, and NoAnswer where it is not there or this role may not ask it.
        """
        return await self._beside(lambda: self._node.ask(prefix, call, timeout_s=timeout_s))

    def follow(self, topic: keys.Topic, told: Callable[[str, Any], None]) -> Callable[[], None]:
        """Call `told(key, message)` on the event loop for what is published; what is returned ends that."""
        loop = asyncio.get_running_loop()

        def receive(key: str, message: Any) -> None:
            with contextlib.suppress(RuntimeError):  # the loop has ended
                loop.call_soon_threadsafe(told, key, message)

        subscriber = bus.follow(self.session, topic, receive)
        return lambda: subscriber.undeclare()

    async def watch(self, query: str, *, inferred: bool) -> tuple[StandingQuery, Callable[[], None]]:
        """A standing query, begun, and what ends it, which waits for the system. Raises as `Client.watch`."""

        def begin() -> tuple[StandingQuery, Callable[[], None]]:
            stack = contextlib.ExitStack()
            return stack.enter_context(self._client.watch(query, inferred=inferred)), stack.close

        return await self._beside(begin)

    async def _beside(self, function: Callable[[], R]) -> R:
        return await asyncio.get_running_loop().run_in_executor(self._threads, function)

    # From the node's thread to the event loop

    def _hand_over(self, news: _News) -> None:
        """On the node's thread: have the event loop take what is new."""
        loop = self._loop
        if loop is not None:
            with contextlib.suppress(RuntimeError):  # the loop has ended
                loop.call_soon_threadsafe(self._take, news)

    def _take(self, news: _News) -> None:
        for happening in self._changes(news):
            for told in tuple(self._told):
                told(happening)

    def _changes(self, news: _News) -> Iterator[Happening]:
        """Let the state be as `news` says, and tell what that changes."""
        if news.begun is not None:
            yield self._begin(news.begun)
        if commits := tuple(commit for commit in news.commits if commit.seq > self.commit):
            for commit in commits:
                for gone in commit.removed:
                    self._entities.pop(gone.name, None)
                self._entities.update((entity.name, entity) for entity in commit.changed)
            self.commit = commits[-1].seq
            yield Happening(kind="commit", commits=commits)
        if news.scene is not None:
            self.scene = news.scene.now
            self._poses.clear()
            self._bends.clear()
            if self.scene is not None:
                self._poses.update((body.name, body.pose) for body in self.scene.bodies)
                self._bends.update(
                    (body.name, bends_of(body.joints)) for body in self.scene.bodies if body.joints
                )
            yield Happening(kind="scene")
        self._poses_heard += news.poses_heard
        if news.moved:
            self._poses.update(news.moved)
            self._bends.update(news.bends)
            yield Happening(kind="poses", names=tuple(news.moved))
        if news.why_not is not None and (self.connected, self.why_not) != (not news.why_not, news.why_not):
            self.connected, self.why_not = not news.why_not, news.why_not
            yield Happening(kind="connection")
        if news.health:
            self.health.update(news.health)
            self._sample()
            yield Happening(kind="health", names=tuple(news.health))

    def _sample(self) -> None:
        now_s = time.time()
        if self.rates.is_due(now_s):
            loads = loads_of(self.health.values())
            self.rates.take(now_s, self.commit, self._poses_heard, loads)

    def _begin(self, begun: _Map) -> Happening:
        is_another = bool(self.map_id) and begun.map_id != self.map_id
        self._entities.clear()
        self._entities.update(begun.entities)
        self.classes, self.commit, self.map_id = begun.classes, begun.seq, begun.map_id
        return Happening(kind="begun", anew=is_another)


class _Map(Struct, frozen=True, kw_only=True):
    map_id: str
    seq: int
    entities: dict[str, Entity]
    classes: tuple[ClassInfo, ...]


class _Bodies(Struct, frozen=True, kw_only=True):
    now: Scene | None


class _News:
    """What has come since it was last handed over; the node's thread fills it, and lets it go whole."""

    def __init__(self) -> None:
        self.begun: _Map | None = None
        self.commits: list[Commit] = []
        self.scene: _Bodies | None = None
        self.moved: dict[str, Pose] = {}
        self.bends: dict[str, Bends] = {}
        self.poses_heard = 0
        self.health: dict[str, Health] = {}
        self.why_not: str | None = None
        """Why there is no knowledge base; nothing while there is one, None where nothing is known."""


class _Following:
    """What the node does, on its own thread: it follows the map, the scene and the nodes."""

    def __init__(self, node: Node, hand_over: Callable[[_News], None], *, secure: bool) -> None:
        self._node = node
        self._hand_over = hand_over
        self._news = _News()
        self._is_due = False
        self._replica = MapReplica[Commit]()
        self._map_id = ""
        self._classes: tuple[ClassInfo, ...] = ()
        self._is_told = False
        """The map as it began has been handed over, so commits count by themselves."""
        self._scene = SceneState()
        self._fetching_scene = False
        self._poses_s = 0.0
        self._kb_s = 0.0
        self._told_s = 0.0
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
        node.every(0.5, self._look)

    def _notice(self) -> None:
        """There is something new: it is told at once, or with what else comes before it is time again."""
        if not self._is_due:
            self._is_due = True
            self._node.later(self._told_s + PERIOD_S - time.monotonic(), self._tell)

    def _tell(self) -> None:
        self._is_due, self._told_s = False, time.monotonic()
        news, self._news = self._news, _News()
        self._hand_over(news)

    # The map

    def _on_commit(self, commit: Commit, known: bool) -> None:
        if known and self._is_told:
            self._news.commits.append(commit)
            self._notice()

    def _on_map(self, begun: SnapshotLoaded) -> None:
        """Which map is it? It is told when that is known."""
        self._is_told, self._classes = False, begun.classes
        self._news.commits.clear()

        def on_copy(future: Future[MapCopy]) -> None:
            if future.exception() is None:
                self._map_id = future.result().map_id
            self._begin()

        self._node.ask_later(keys.BRIDGE, CopyQuery(content=False)).add_done_callback(on_copy)

    def _begin(self) -> None:
        self._is_told = True
        self._news.commits.clear()
        self._news.begun = _Map(
            map_id=self._map_id,
            seq=self._replica.seq,
            entities=dict(self._replica.entities),
            classes=self._classes,
        )
        self._look()

    # The nodes

    def _on_health(self, health: Health) -> None:
        if health.node == "kb_node":
            self._kb_s = time.monotonic()
        self._news.health[health.node] = health
        self._notice()

    def _look(self) -> None:
        self._news.why_not = self._why_not()
        self._notice()
        if self._scene.known and time.monotonic() - self._poses_s > _SCENE_LOST_S:
            self._scene = SceneState()
            self._news.scene, self._news.moved = _Bodies(now=None), {}
            self._news.bends.clear()

    def _why_not(self) -> str:
        if time.monotonic() - self._kb_s > _SILENT_S:
            if self._kb_s:
                return "the knowledge base does not answer; the page goes on as soon as it is back"
            return "no knowledge base answers; the page begins as soon as one does (semmap up)"
        return "" if self._is_told else "the map is being read"

    # The scene

    def _on_poses(self, poses: Poses) -> None:
        self._poses_s = time.monotonic()
        self._news.poses_heard += 1
        if not self._scene.matches(poses):
            self._fetch_scene()
            return
        moved = dict(self._scene.follow(poses))
        if moved:
            self._news.moved.update(moved)
            bodies = (self._scene.bodies[name] for name in moved)
            self._news.bends.update((body.name, bends_of(body.joints)) for body in bodies if body.joints)
            self._notice()

    def _fetch_scene(self) -> None:
        if self._fetching_scene:
            return
        self._fetching_scene = True

        def on_scene(future: Future[Scene]) -> None:
            self._fetching_scene = False
            if future.exception() is None:
                self._scene.take(future.result())
                self._news.scene, self._news.moved = _Bodies(now=future.result()), {}
                self._news.bends.clear()
                self._notice()

        self._node.ask_later(keys.SIM, SceneQuery()).add_done_callback(on_scene)
