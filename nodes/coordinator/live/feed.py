"""Live poses on the wire: in by `semmap/live/<name>` and the simulator's poses, out by `semmap/live`."""

from __future__ import annotations

import time
from collections.abc import Callable, Collection
from concurrent.futures import Future
from functools import partial

from msgspec import structs

from semmap.nodes import bus
from semmap.nodes.coordinator import holding
from semmap.nodes.coordinator.config import CoordinatorConfig
from semmap.nodes.coordinator.door.known_map import KnownMap
from semmap.nodes.coordinator.live.live_poses import Due, LivePoses
from semmap.nodes.coordinator.scene.scene_view import SceneView
from semmap.nodes.coordinator.scene.settled import Settled
from semmap.nodes.runtime.loop import Node
from semmap.schemas import codec, errors, keys
from semmap.schemas import live as messages
from semmap.schemas.attachments import holder_of
from semmap.schemas.entities import Entity, Live, Pose, Source, Tracking, rounded
from semmap.schemas.replies import Changed

_PERIOD_S = 0.1
_AT_LEAST_S = 1.0
"""Whoever has just started hears of what does not move within this time."""


class LiveFeed:
    """Owned by the coordinator's thread. Poses are read in batches: a hundred things at 50 Hz cost little."""

    def __init__(
        self,
        node: Node,
        config: CoordinatorConfig,
        known_map: KnownMap,
        scene: SceneView,
        change: Callable[[Settled], Future[Changed]],
    ) -> None:
        """`change(settled)` changes the map in its turn."""
        self._node = node
        self._map = known_map
        self._scene = scene
        self._scene_heard_s = 0.0
        self._change = change
        self._poses = LivePoses(config.live, config.thresholds)
        self._under_way: set[str] = set()
        self._may_follow = config.truth != "replayed"
        self._has_bodies = config.truth in ("map", "scene")
        """Whether the bodies of the scene are where the map's entities are."""
        self._published: dict[str, tuple[Pose, int]] = {}
        self._published_s = 0.0
        self._stream = bus.Newest(node.session, keys.LIVE_POSE)
        self._out = bus.publisher(node.session, keys.LIVE_POSES)
        node.every(_PERIOD_S, self._tick)

    def on_scene(self) -> None:
        """The simulator has just told where bodies are."""
        self._scene_heard_s = time.monotonic()

    def scene_age_s(self) -> float:
        """How long ago the simulator told where bodies are [s]."""
        return time.monotonic() - self._scene_heard_s

    def of(self, entity: Entity) -> Live | None:
        """Where a tracked entity is just now, if that was ever heard."""
        if not entity.tracked:
            return self._carried(entity)
        self._read()
        return self._poses.live(entity.name, time.monotonic())

    def where(self, name: str) -> Pose | None:
        """Where an entity is just now, by what is known best: live, its body, what holds it, or the map."""
        return self._where(name, ())

    def _where(self, name: str, above: tuple[str, ...]) -> Pose | None:
        entity = self._map.entities.get(name)
        if entity is None or name in above:
            return None
        live = self.of(entity) if entity.tracked else None
        if live is not None and not live.stale:
            return live.pose
        body = self._scene.bodies.get(name) if self._has_bodies and self._scene.known else None
        if body is not None and entity.tracked != "stream":
            return body.pose
        return holding.carried_pose(entity, lambda by: self._where(by, (*above, name))) or entity.pose

    def _carried(self, entity: Entity) -> Live | None:
        """Where a thing is that something holds: as new as is known of that."""
        if not (by := holder_of(entity)) or (pose := self.where(entity.name)) is None:
            return None
        holder = self._map.entities.get(by)
        known = self.of(holder) if holder is not None else None
        if known is not None:
            return structs.replace(known, pose=rounded(pose))
        source: Tracking = "sim" if entity.name in self._scene.bodies and self._has_bodies else "stream"
        return Live(pose=rounded(pose), stamp_ns=time.time_ns(), age_s=0.0, source=source)

    def problems(self) -> list[str]:
        """What is amiss with live poses, one sentence each."""
        return list(self._poses.problems(self._map.tracked, time.monotonic()))

    def displaced(self, names: Collection[str] = ()) -> tuple[str, ...]:
        """Return which entities (of these, if there are any) a stream has away from their committed pose."""
        tracked = {n: e for n, e in self._map.tracked.items() if not names or n in names}
        return tuple(self._poses.displaced(tracked, time.monotonic()))

    def settle(self, name: str) -> Future[Changed] | None:
        """Commit where an entity is just now; None where that is not known, or is what the map says."""
        entity = self._map.tracked.get(name)
        live = None if entity is None else self.of(entity)
        if entity is None or live is None or live.stale or live.pose == entity.pose:
            return None
        return self._commit(Due(name, live.pose, f"{name} is no longer tracked"))

    def _read(self) -> None:
        now_s, tracked, poses = time.monotonic(), self._map.tracked, self._poses
        for key, read in self._stream.take():
            poses.read(keys.of_live_pose(key), partial(_pose, read), self._map.entities, now_s)
        if self._scene.known:
            for name, entity in tracked.items():
                body = self._scene.bodies.get(name) if entity.tracked == "sim" else None
                if body is not None:
                    poses.take(name, body.pose, self._scene.stamp_ns, self._scene_heard_s, "sim")

    def _tick(self) -> None:
        if self._map.seq < 0:
            return
        self._poses.forget(self._map.tracked)
        self._read()
        now_s = time.monotonic()
        for due in [*self._poses.due(self._map.tracked, now_s)]:
            if due.name not in self._under_way and self._may_follow and due.name not in self._map.held:
                self._commit(due)
        self._publish(now_s)

    def _commit(self, due: Due) -> Future[Changed]:
        self._under_way.add(due.name)
        source: Source = "scene" if self._map.tracked[due.name].tracked == "sim" else "perception"

        def on_done(done: Future[Changed]) -> None:
            self._under_way.discard(due.name)
            error = done.exception()
            self._poses.journalled(due.name, time.monotonic(), refused=error is not None)
            if error is not None and not isinstance(error, errors.NoAnswer):
                self._node.report(f"{due.name}: the map cannot take over its live pose: {error}")

        made = self._change(
            Settled.of(self._map.entities, {due.name: due.pose}, source=source, reason=due.reason)
        )
        made.add_done_callback(on_done)
        return made

    def _publish(self, now_s: float) -> None:
        current = self._poses.current(now_s)
        for name, entity in self._map.held.items():
            if name not in current and (live := self._carried(entity)) is not None and not live.stale:
                current[name] = live
        told = {
            name: (live.pose, live.stamp_ns if name not in self._map.held else 0)
            for name, live in current.items()
        }
        if told == self._published and (not told or now_s - self._published_s < _AT_LEAST_S):
            return
        self._published, self._published_s = told, now_s
        message = messages.LivePoses(stamp_ns=time.time_ns(), entities=current)
        self._out.put(codec.encode(message), encoding=codec.encoding_of(message))


def _pose(read: Callable[[], messages.LivePose]) -> tuple[Pose, int]:
    """With the stamp that it has, or that of its arrival. Raises BadRequest."""
    message = read()
    return message.require_pose(), message.stamp_ns or time.time_ns()
