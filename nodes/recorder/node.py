"""The recorder on the wire: it follows commits, poses, what is seen, and the knowledge base's heartbeat."""

from __future__ import annotations

import time
from concurrent.futures import Future
from typing import Any

from nodes.recorder.config import RecorderConfig
from nodes.recorder.drawing.graph import graph_of
from nodes.recorder.drawing.stage import Stage
from nodes.recorder.drawing.surfaces import Kind
from nodes.recorder.perception_recorder import PerceptionRecorder
from nodes.recorder.recording import Recording, free_to_serve, open_recording
from nodes.recorder.state.map_state import MapState, missed
from nodes.recorder.state.scene_state import SceneState
from nodes.runtime.loop import Node, open_node
from schemas import keys, wording
from schemas.bridge import Recall, SnapshotQuery, StarQuery
from schemas.commits import Commit, Snapshot
from schemas.health import Health
from schemas.scenes import Poses, Scene, SceneQuery, SurfaceQuery, Surfaces

_SCENE_LOST_S = 10.0
"""A simulator that says nothing for so long is gone; making thousands of bodies takes seconds."""
_RECALLED_AT_ONCE = 20
_SURFACES_AT_ONCE = 50


class Recorder:
    """Binds the recording to the wire."""

    def __init__(self, node: Node, recording: Recording, live: str) -> None:
        self._node = node
        self._recording = recording
        self._live = live
        self._stage = Stage(recording)
        self._map = MapState()
        self._scene = SceneState()
        self._early: list[Commit] = []
        self._has_map = False
        self._arranged = False
        self._fetching_map = False
        self._fetching_scene = False
        self._poses_at = 0.0
        self._kb_started_ns = 0
        node.follow(keys.COMMIT, self._on_commit)
        node.follow(keys.POSES, self._on_poses)
        node.follow(keys.HEALTH, self._on_health)
        node.every(0.5, self._tick)
        PerceptionRecorder(node, recording, self._at)

    # The map

    def _on_commit(self, commit: Commit) -> None:
        """Record it at once, whatever is known of the map; the map follows in order."""
        self._at(commit.stamp_ns, commit.seq)
        self._recording.commit(commit)
        if self._has_map and self._map.take(commit):
            self._show_commit(commit)
        else:
            self._early.append(commit)
            self._has_map = False
            self._fetch_map()

    def _show_commit(self, commit: Commit) -> None:
        touched = {entity.name for entity in commit.changed} | {gone.name for gone in commit.removed}
        self._stage.show(sorted(touched), self._map.entities, self._scene.bodies, simulated=self._scene.known)
        self._shown()

    def _fetch_map(self) -> None:
        """Ask for a snapshot and for the relations: at the start, and when a commit was missed."""
        if self._fetching_map:
            return
        self._fetching_map = True
        snapshots: list[Snapshot] = []

        def on_snapshot(future: Future[Snapshot]) -> None:
            if future.exception() is not None:
                self._fetching_map = False
                return
            snapshots.append(future.result())
            names = tuple(entity.name for entity in snapshots[0].entities)
            self._node.ask_later(keys.BRIDGE, StarQuery(names=names)).add_done_callback(on_stars)

        def on_stars(future: Future[Any]) -> None:
            self._fetching_map = False
            if future.exception() is None:
                self._begin(snapshots[0], future.result())

        self._node.ask_later(keys.BRIDGE, SnapshotQuery()).add_done_callback(on_snapshot)

    def _begin(self, snapshot: Snapshot, stars: Any) -> None:
        first = self._map.seq < 0
        after = snapshot.seq - 1 if first else self._map.seq
        lost = missed(after, snapshot.seq, self._early)
        anew = snapshot.seq < self._map.seq
        self._map.begin(snapshot)
        self._map.relate(stars)
        early = sorted(self._early, key=lambda commit: commit.seq)
        self._has_map = all(self._map.take(commit) for commit in early)  # else one between is missing
        self._early.clear()
        self._at(time.time_ns(), self._map.seq)
        if first or anew:
            known = wording.entities(len(self._map.entities))
            self._recording.note(f"{self._map.seq}  the recording goes on from here with {known}")
        self._recall(lost)
        self._show_all()
        self._shown()

    def _recall(self, seqs: list[int]) -> None:
        """Record what was committed while nobody listened, and the commit that the recording starts with."""
        for start in range(0, len(seqs), _RECALLED_AT_ONCE):
            some = tuple(seqs[start : start + _RECALLED_AT_ONCE])
            self._node.ask_later(keys.BRIDGE, Recall(seqs=some)).add_done_callback(self._on_recalled)

    def _on_recalled(self, future: Future[tuple[Commit, ...]]) -> None:
        if (error := future.exception()) is not None:
            self._recording.note(f"commits are missing here: {error}", warning=True)
            return
        for commit in future.result():
            self._at(commit.stamp_ns, commit.seq)
            self._recording.commit(commit)

    def _on_health(self, health: Health) -> None:
        """A new knowledge base may know another map, or have made commits that nobody heard."""
        if health.node == "kb_node" and health.state == "ready" and health.started_ns != self._kb_started_ns:
            self._kb_started_ns = health.started_ns
            self._has_map = False
            self._fetch_map()

    # The scene

    def _on_poses(self, poses: Poses) -> None:
        self._poses_at = time.monotonic()
        if not self._scene.matches(poses):
            self._fetch_scene()
            return
        self._at(poses.stamp_ns)
        for name, pose in self._scene.follow(poses):
            self._stage.move(name, pose)

    def _fetch_scene(self) -> None:
        if self._fetching_scene:
            return
        self._fetching_scene = True

        def on_scene(future: Future[Scene]) -> None:
            self._fetching_scene = False
            if future.exception() is None:
                scene = future.result()
                self._scene.take(scene)
                self._at(scene.stamp_ns)
                self._show_all()
                self._fetch_surfaces()

        self._node.ask_later(keys.SIM, SceneQuery()).add_done_callback(on_scene)

    def _fetch_surfaces(self) -> None:
        """Ask what the bodies look like, as far as that was never told."""
        wanted = list(self._stage.surfaces.wanted(self._scene.bodies.values()).items())
        for start in range(0, len(wanted), _SURFACES_AT_ONCE):
            self._fetch_some_surfaces(dict(wanted[start : start + _SURFACES_AT_ONCE]))

    def _fetch_some_surfaces(self, kinds: dict[str, Kind]) -> None:
        def on_surfaces(future: Future[Surfaces]) -> None:
            if future.exception() is not None:
                self._stage.surfaces.give_up(kinds.values())
                return
            for name, surface in future.result().surfaces.items():
                self._stage.surfaces.take(kinds[name], surface)
            self._at(time.time_ns())
            self._show_all()

        query = SurfaceQuery(names=tuple(kinds))
        self._node.ask_later(keys.SIM, query).add_done_callback(on_surfaces)

    def _tick(self) -> None:
        if not self._has_map:
            self._fetch_map()
        if self._scene.known and time.monotonic() - self._poses_at > _SCENE_LOST_S:
            self._scene = SceneState()
            self._at(time.time_ns())
            self._show_all()

    # Both

    def _at(self, stamp_ns: int, seq: int | None = None) -> None:
        """What is recorded from now on is of this time."""
        self._recording.at(max(0, self._map.seq) if seq is None else seq, stamp_ns, self._scene.sim_time_s)

    def _show_all(self) -> None:
        self._stage.show_all(self._map.entities, self._scene.bodies, simulated=self._scene.known)

    def _shown(self) -> None:
        self._stage.show_graph(graph_of(self._map.entities, self._map.relations()))
        if not self._arranged and self._map.entities:
            self._arranged = True
            self._recording.arrange(self._stage.poses)
        self._node.ready(f"commit {self._map.seq}, into {self._recording.path.name}, {self._live}")


def run(config: RecorderConfig) -> None:
    """Record until stopped. Raises BadFile when the file cannot be written."""
    serve = config.serve if config.serve is not None and free_to_serve(config.serve) else None
    live = f"live at {serve}" if serve else "no live view"
    if config.serve is not None and serve is None:
        live = f"no live view: {config.serve} is taken"
    with (
        open_node("recorder", config.network) as node,
        open_recording(config.path, serve) as recording,
    ):
        Recorder(node, recording, live)
        node.run()
