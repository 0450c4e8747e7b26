"""Live poses on Zenoh: in on `semmap/live/<name>` and from the simulator, out on `semmap/live`."""

from __future__ import annotations

import time
from collections.abc import Callable, Collection
from concurrent.futures import Future
from functools import partial

from msgspec import structs

from semmap.nodes import bus
from semmap.nodes.coordinator.commands import attachment_rules
from semmap.nodes.coordinator.commands.map_view import MapView
from semmap.nodes.coordinator.config import CoordinatorConfig
from semmap.nodes.coordinator.live.live_poses import Due, LivePoses
from semmap.nodes.coordinator.reconciler.observed_state import ObservedState
from semmap.nodes.coordinator.scene.scene_view import SceneView
from semmap.nodes.runtime.loop import Node
from semmap.schemas import codec, errors, keys
from semmap.schemas import live as messages
from semmap.schemas.attachments import holder_of
from semmap.schemas.entities import Entity, Live, Pose, Source, Tracking, rounded
from semmap.schemas.replies import Changed

_PERIOD_S = 0.1
_REPUBLISH_S = 1.0
"""A new subscriber receives the poses of resting entities within this time."""


class LiveFeed:
    """Owned by the coordinator's thread. Poses are read in batches: 100 entities at 50 Hz cost little."""

    def __init__(
        self,
        node: Node,
        config: CoordinatorConfig,
        map_view: MapView,
        scene: SceneView,
        change: Callable[[ObservedState], Future[Changed]],
    ) -> None:
        """`change(observed)` changes the map in its turn."""
        self._node = node
        self._map = map_view
        self._scene = scene
        self._scene_received_s = 0.0
        self._change = change
        self._poses = LivePoses(config.live, config.thresholds)
        self._committing: set[str] = set()
        self._may_follow = config.truth != "replayed"
        self._has_bodies = config.truth in ("map", "scene")
        """Whether the scene's bodies are at the poses of the map's entities."""
        self._published: dict[str, tuple[Pose, int]] = {}
        self._published_s = 0.0
        self._stream = bus.NewestSamples(node.session, keys.LIVE_POSE)
        self._out = bus.publisher(node.session, keys.LIVE_POSES)
        node.every(_PERIOD_S, self._tick)

    def on_scene(self) -> None:
        """Note that poses have arrived from the simulator."""
        self._scene_received_s = time.monotonic()

    def scene_age_s(self) -> float:
        """Return the age of the last poses from the simulator [s]."""
        return time.monotonic() - self._scene_received_s

    def live_pose(self, entity: Entity) -> Live | None:
        """Return the live pose of a tracked or attached entity, if it was ever received."""
        if not entity.tracked:
            return self._attached(entity)
        self._read()
        return self._poses.live(entity.name, time.monotonic())

    def pose_of(self, name: str) -> Pose | None:
        """Return the best known pose of an entity: live, of its body, from its holder, or committed."""
        return self._find_pose(name, ())

    def _find_pose(self, name: str, above: tuple[str, ...]) -> Pose | None:
        entity = self._map.entities.get(name)
        if entity is None or name in above:
            return None
        live = self.live_pose(entity) if entity.tracked else None
        if live is not None and not live.stale:
            return live.pose
        body = self._scene.bodies.get(name) if self._has_bodies and self._scene.known else None
        if body is not None and entity.tracked != "stream":
            return body.pose
        return (
            attachment_rules.attached_pose(entity, lambda by: self._find_pose(by, (*above, name)))
            or entity.pose
        )

    def _attached(self, entity: Entity) -> Live | None:
        """Return the live pose of an attached entity, with the age of its holder's pose."""
        if not (by := holder_of(entity)) or (pose := self.pose_of(entity.name)) is None:
            return None
        holder = self._map.entities.get(by)
        known = self.live_pose(holder) if holder is not None else None
        if known is not None:
            return structs.replace(known, pose=rounded(pose))
        source: Tracking = "sim" if entity.name in self._scene.bodies and self._has_bodies else "stream"
        return Live(pose=rounded(pose), stamp_ns=time.time_ns(), age_s=0.0, source=source)

    def problems(self) -> list[str]:
        """Return the problems of live poses, one sentence each."""
        return list(self._poses.problems(self._map.tracked, time.monotonic()))

    def displaced(self, names: Collection[str] = ()) -> tuple[str, ...]:
        """Return the entities (of `names`, if given) whose live pose differs from the committed one."""
        tracked = {n: e for n, e in self._map.tracked.items() if not names or n in names}
        return tuple(self._poses.displaced(tracked, time.monotonic()))

    def commit_pose(self, name: str) -> Future[Changed] | None:
        """Commit the live pose of an entity; None if it is unknown or already committed."""
        entity = self._map.tracked.get(name)
        live = None if entity is None else self.live_pose(entity)
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
                    poses.take(name, body.pose, self._scene.stamp_ns, self._scene_received_s, "sim")

    def _tick(self) -> None:
        if self._map.seq < 0:
            return
        self._poses.forget(self._map.tracked)
        self._read()
        now_s = time.monotonic()
        for due in [*self._poses.due(self._map.tracked, now_s)]:
            if due.name not in self._committing and self._may_follow and due.name not in self._map.held:
                self._commit(due)
        self._publish(now_s)

    def _commit(self, due: Due) -> Future[Changed]:
        self._committing.add(due.name)
        source: Source = "scene" if self._map.tracked[due.name].tracked == "sim" else "perception"

        def on_done(done: Future[Changed]) -> None:
            self._committing.discard(due.name)
            error = done.exception()
            self._poses.note_commit(due.name, time.monotonic(), refused=error is not None)
            if error is not None and not isinstance(error, errors.NoAnswer):
                self._node.report(f"{due.name}: the live pose is not committed: {error}")

        made = self._change(
            ObservedState.of(self._map.entities, {due.name: due.pose}, source=source, reason=due.reason)
        )
        made.add_done_callback(on_done)
        return made

    def _publish(self, now_s: float) -> None:
        current = self._poses.current(now_s)
        for name, entity in self._map.held.items():
            if name not in current and (live := self._attached(entity)) is not None and not live.stale:
                current[name] = live
        state = {
            name: (live.pose, live.stamp_ns if name not in self._map.held else 0)
            for name, live in current.items()
        }
        if state == self._published and (not state or now_s - self._published_s < _REPUBLISH_S):
            return
        self._published, self._published_s = state, now_s
        message = messages.LivePoses(stamp_ns=time.time_ns(), entities=current)
        self._out.put(codec.encode(message), encoding=codec.encoding_of(message))


def _pose(read: Callable[[], messages.LivePose]) -> tuple[Pose, int]:
    """Return the pose with its stamp, or with the time of arrival. Raises BadRequest."""
    message = read()
    return message.require_pose(), message.stamp_ns or time.time_ns()
