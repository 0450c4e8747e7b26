"""The recorder node: it subscribes to the map, the poses and perception."""

from __future__ import annotations

import logging
import time
from collections.abc import Collection
from concurrent.futures import Future

from semmap.nodes.drawing.scene_state import SceneState
from semmap.nodes.drawing.surfaces import Kind
from semmap.nodes.recorder.config import RecorderConfig
from semmap.nodes.recorder.drawing.drawn_scene import DrawnScene
from semmap.nodes.recorder.drawing.graph import graph_of
from semmap.nodes.recorder.file_monitor import CHECK_S, FileMonitor
from semmap.nodes.recorder.map_relations import Relations, changed_subjects, missed_commits
from semmap.nodes.recorder.perception_recorder import PerceptionRecorder
from semmap.nodes.recorder.recording import Recording, free_to_serve, open_recording
from semmap.nodes.recorder.retention import KEEP_ALL, Retention, recordings
from semmap.nodes.runtime.loop import Node, open_node
from semmap.nodes.runtime.map_follower import Follower, SnapshotLoaded
from semmap.nodes.runtime.map_replica import MapReplica
from semmap.schemas import keys, wording
from semmap.schemas.bridge import Recall, StarQuery
from semmap.schemas.commits import MANY_ENTITIES, Commit, Star
from semmap.schemas.live import LivePoses
from semmap.schemas.scenes import Poses, Scene, SceneQuery, SurfaceQuery, Surfaces

log = logging.getLogger(__name__)

_RETENTION_S = 10.0
_SCENE_LOST_S = 10.0
"""A simulator that sends no poses for this long is gone. Creating thousands of bodies takes seconds."""
_COMMITS_A_REQUEST = 20
_SURFACES_A_REQUEST = 50
_RETRY_S = 2.0
"""Time after which surfaces that did not arrive are requested again."""


class Recorder:
    """Connects the recording to the network."""

    def __init__(
        self,
        node: Node,
        recording: Recording,
        live: str,
        keep: Retention = KEEP_ALL,
        after: int | None = None,
        begun_ns: int = 0,
    ) -> None:
        """Register the subscribers.

        `live` describes the live view; `keep`, `after` and `begun_ns` are as in the configuration.
        """
        self._node = node
        self._recording = recording
        self._live = live
        self._drawn = DrawnScene(recording)
        self._map = MapReplica[Commit]()
        self._relations = Relations()
        self._has_relations = False
        self._requesting_relations = False
        self._commits_since_request: list[Commit] = []
        self._unknown: list[Commit] = []
        self._scene = SceneState()
        self._arranged = False
        self._fetching_scene = False
        self._poses_at = 0.0
        Follower(node, self._map, keys.COMMIT, on_commit=self._on_commit, on_snapshot=self._on_map)
        node.follow(keys.POSES, self._on_poses)
        node.follow_newest(keys.LIVE_POSES, self._on_live)
        node.every(0.5, self._tick)
        self._file_monitor, self._problem = FileMonitor(recording.path), ""
        self._keep, self._after, self._begun_s = keep, after, time.time()
        self._begun_ns, self._first = begun_ns if after is None else 0, 0
        self.is_full = False
        node.every(CHECK_S, self._check_file)
        node.every(_RETENTION_S, self._apply_retention)
        PerceptionRecorder(node, recording, self._set_time)

    # The map

    def _on_commit(self, commit: Commit, known: bool) -> None:
        """Record a commit immediately. The map is updated in order."""
        self._set_time(commit.stamp_ns, commit.seq)
        self._recording.commit(commit)
        self._relations.take(commit)
        if self._requesting_relations:
            self._commits_since_request.append(commit)
        if not known:
            self._unknown.append(commit)
        elif self._has_relations:
            self._show_commit(commit)

    def _show_commit(self, commit: Commit) -> None:
        touched = sorted(commit.names)
        self._drawn.show(touched, self._map.entities, self._scene.bodies, simulated=self._scene.known)
        self._show_graph(touched or changed_subjects(commit.places))

    def _on_map(self, begun: SnapshotLoaded) -> None:
        first = begun.before < 0
        before = begun.before
        if first:
            self._first = begun.seq
            before = max(0, begun.seq - _COMMITS_A_REQUEST) if self._after is None else self._after
        lost = missed_commits(before, begun.seq, self._unknown)
        self._unknown.clear()
        self._set_time(time.time_ns(), self._map.seq)
        if first or begun.seq < begun.before:
            known = wording.entities(len(self._map.entities))
            self._recording.note(f"{self._map.seq}  the recording continues from here with {known}")
        self._fetch_commits(lost)
        self._has_relations = False
        self._request_relations()

    def _request_relations(self) -> None:
        """Request the entity triples. Commits that arrive before the reply may be newer."""
        if self._requesting_relations:
            return
        if len(self._map.entities) > MANY_ENTITIES:  # more triples than a message holds
            self._has_relations = True
            self._relations.begin(())
            self._recording.note(f"relations are not drawn for more than {MANY_ENTITIES} entities")
            self._show_all()
            self._show_graph()
            return
        self._requesting_relations = True

        def on_triples(future: Future[tuple[Star, ...]]) -> None:
            since, self._commits_since_request, self._requesting_relations = (
                self._commits_since_request,
                [],
                False,
            )
            if future.exception() is not None:
                return  # retried at the next tick
            self._has_relations = True
            self._relations.begin(future.result())
            for commit in since:
                self._relations.take(commit)
            self._set_time(time.time_ns(), self._map.seq)
            self._show_all()
            self._show_graph()

        query = StarQuery(names=tuple(self._map.entities))
        self._node.ask_later(keys.BRIDGE, query).add_done_callback(on_triples)

    def _fetch_commits(self, seqs: list[int]) -> None:
        """Record commits that were missed, and those that the recording starts with."""
        for start in range(0, len(seqs), _COMMITS_A_REQUEST):
            some = tuple(seqs[start : start + _COMMITS_A_REQUEST])
            self._node.ask_later(keys.BRIDGE, Recall(seqs=some)).add_done_callback(self._on_commits)

    def _on_commits(self, future: Future[tuple[Commit, ...]]) -> None:
        if (error := future.exception()) is not None:
            self._recording.note(f"some commits could not be recorded: {error}", warning=True)
            return
        for commit in future.result():
            if commit.seq >= self._first or commit.stamp_ns >= self._begun_ns:
                self._set_time(commit.stamp_ns, commit.seq)
                self._recording.commit(commit)

    # The scene

    def _on_poses(self, poses: Poses) -> None:
        self._poses_at = time.monotonic()
        if not self._scene.matches(poses):
            self._fetch_scene()
            return
        if problem := self._scene.find_problem(poses):
            self._node.drop(f"poses dropped: {problem}")
            return
        self._set_time(poses.stamp_ns)
        jointed = []
        for name, pose in self._scene.follow(poses):
            self._drawn.move(name, pose)
            if self._scene.bodies[name].joints:
                jointed.append(name)
        self._drawn.show(jointed, self._map.entities, self._scene.bodies, simulated=True)

    def _on_live(self, live: LivePoses) -> None:
        """Move entities that are tracked from a stream. The simulator publishes its own poses."""
        self._set_time(live.stamp_ns)
        for name, seen in live.entities.items():
            if seen.source == "stream":
                self._drawn.move(name, seen.pose)

    def _fetch_scene(self) -> None:
        if self._fetching_scene:
            return
        self._fetching_scene = True

        def on_scene(future: Future[Scene]) -> None:
            self._fetching_scene = False
            if future.exception() is None:
                scene = future.result()
                self._scene.take(scene)
                self._set_time(scene.stamp_ns)
                self._show_all()
                self._fetch_surfaces()

        self._node.ask_later(keys.SIM, SceneQuery()).add_done_callback(on_scene)

    def _fetch_surfaces(self) -> None:
        """Request surfaces of bodies that were not requested yet."""
        wanted = list(self._drawn.surfaces.wanted(self._scene.bodies.values()).items())
        for start in range(0, len(wanted), _SURFACES_A_REQUEST):
            self._fetch_some_surfaces(dict(wanted[start : start + _SURFACES_A_REQUEST]))

    def _fetch_some_surfaces(self, kinds: dict[str, Kind]) -> None:
        def on_surfaces(future: Future[Surfaces]) -> None:
            if future.exception() is not None:
                self._drawn.surfaces.reset_requests(kinds.values())
                self._node.later(_RETRY_S, self._fetch_surfaces)
                return
            if not self._drawn.surfaces.take_reply(kinds, future.result().surfaces):
                self._node.later(_RETRY_S, self._fetch_surfaces)
            self._set_time(time.time_ns())
            self._show_all()

        query = SurfaceQuery(names=tuple(kinds))
        self._node.ask_later(keys.SIM, query).add_done_callback(on_surfaces)

    def _tick(self) -> None:
        if self._map.seq >= 0 and not self._has_relations:
            self._request_relations()
        if self._scene.known and time.monotonic() - self._poses_at > _SCENE_LOST_S:
            self._scene = SceneState()
            self._set_time(time.time_ns())
            self._show_all()

    def _check_file(self) -> None:
        """Report in the status that the recording is not written, for as long as this lasts."""
        before, self._problem = self._problem, self._file_monitor.find_problem(self._recording.logged)
        if self._problem and not before:
            self._node.report(self._problem)
        if self._problem != before:
            self._describe()

    def _apply_retention(self) -> None:
        """Delete old recordings, and request a new file if this one is too large or old."""
        path, now_s = self._recording.path, time.time()
        by_path = {file.path: file for file in recordings(path.parent)}
        if (current := by_path.pop(path, None)) is None:
            return
        for file in self._keep.surplus(by_path.values(), current, now_s):
            file.path.unlink(missing_ok=True)
            log.info("deleted %s (--record-keep)", file.path)
        if self._map.seq >= 0 and self._keep.is_full(current, self._begun_s, now_s):
            self.is_full = True
            self._node.stop()

    @property
    def recorded(self) -> int:
        """Return the last recorded commit."""
        return self._map.seq

    # Both

    def _set_time(self, stamp_ns: int, seq: int | None = None) -> None:
        """Set the time of the following records."""
        self._recording.set_time(
            max(0, self._map.seq) if seq is None else seq, stamp_ns, self._scene.sim_time_s
        )

    def _show_all(self) -> None:
        self._drawn.show_all(self._map.entities, self._scene.bodies, simulated=self._scene.known)

    def _show_graph(self, touched: Collection[str] = ()) -> None:
        relations = self._relations.between(self._map.entities)
        self._drawn.show_graph(graph_of(self._map.entities, relations, touched))
        if not self._arranged and self._map.entities:
            self._arranged = True
            self._recording.arrange(self._drawn.poses)
        self._describe()

    def _describe(self) -> None:
        into = f"into {self._recording.path.name}, {self._live}"
        self._node.ready(f"commit {self._map.seq}, {self._problem or into}")


def run(config: RecorderConfig) -> int | None:
    """Record until stopped, and return None, or until a new file must be started.

    In the second case, returns the last recorded commit. Raises BadFile if the file cannot be written.
    """
    serve = config.serve if config.serve is not None and free_to_serve(config.serve) else None
    live = f"live at {serve}" if serve else "no live view"
    if config.serve is not None and serve is None:
        live = f"no live view: {config.serve} is in use"
    with (
        open_node("recorder", config.network) as node,
        open_recording(config.path, serve) as recording,
    ):
        recorder = Recorder(node, recording, live, config.keep, config.after, config.begun_ns)
        node.run()
        return recorder.recorded if recorder.is_full else None
