"""The recorder on the wire: it follows the map, the poses, and what is seen."""

from __future__ import annotations

import logging
import time
from collections.abc import Collection
from concurrent.futures import Future

from semmap.nodes.drawing.scene_state import SceneState
from semmap.nodes.drawing.surfaces import Kind
from semmap.nodes.recorder.config import RecorderConfig
from semmap.nodes.recorder.drawing.graph import graph_of
from semmap.nodes.recorder.drawing.stage import Stage
from semmap.nodes.recorder.growth import LOOK_S, Growth
from semmap.nodes.recorder.perception_recorder import PerceptionRecorder
from semmap.nodes.recorder.recording import Recording, free_to_serve, open_recording
from semmap.nodes.recorder.retention import KEEP_ALL, Retention, recordings
from semmap.nodes.recorder.state.map_relations import Relations, missed, subjects
from semmap.nodes.runtime.loop import Node, open_node
from semmap.nodes.runtime.map_follower import Follower, SnapshotLoaded
from semmap.nodes.runtime.map_replica import MapReplica
from semmap.schemas import keys, wording
from semmap.schemas.bridge import Recall, StarQuery
from semmap.schemas.commits import MANY_ENTITIES, Commit, Star
from semmap.schemas.live import LivePoses
from semmap.schemas.scenes import Poses, Scene, SceneQuery, SurfaceQuery, Surfaces

log = logging.getLogger(__name__)

_TIDY_S = 10.0
_SCENE_LOST_S = 10.0
"""A simulator that says nothing for so long is gone; making thousands of bodies takes seconds."""
_RECALLED_AT_ONCE = 20
_SURFACES_AT_ONCE = 50


class Recorder:
    """Binds the recording to the wire."""

    def __init__(
        self,
        node: Node,
        recording: Recording,
        live: str,
        keep: Retention = KEEP_ALL,
        after: int | None = None,
    ) -> None:
        """`live` says in words where it is seen live; `keep` and `after` are those of the configuration."""
        self._node = node
        self._recording = recording
        self._live = live
        self._stage = Stage(recording)
        self._map = MapReplica[Commit]()
        self._relations = Relations()
        self._related = False
        self._asking_stars = False
        self._since_asked: list[Commit] = []
        self._unknown: list[Commit] = []
        self._scene = SceneState()
        self._arranged = False
        self._fetching_scene = False
        self._poses_at = 0.0
        Follower(node, self._map, keys.COMMIT, on_commit=self._on_commit, on_snapshot=self._on_map)
        node.follow(keys.POSES, self._on_poses)
        node.follow_newest(keys.LIVE_POSES, self._on_live)
        node.every(0.5, self._tick)
        self._growth, self._amiss = Growth(recording.path), ""
        self._keep, self._after, self._begun_s = keep, after, time.time()
        self.is_full = False
        node.every(LOOK_S, self._look_after_the_file)
        node.every(_TIDY_S, self._tidy)
        PerceptionRecorder(node, recording, self._at)

    # The map

    def _on_commit(self, commit: Commit, known: bool) -> None:
        """Record it at once, whatever is known of the map; the map follows in order."""
        self._at(commit.stamp_ns, commit.seq)
        self._recording.commit(commit)
        self._relations.take(commit)
        if self._asking_stars:
            self._since_asked.append(commit)
        if not known:
            self._unknown.append(commit)
        elif self._related:
            self._show_commit(commit)

    def _show_commit(self, commit: Commit) -> None:
        touched = sorted(commit.names)
        self._stage.show(touched, self._map.entities, self._scene.bodies, simulated=self._scene.known)
        self._shown(touched or subjects(commit.places))

    def _on_map(self, begun: SnapshotLoaded) -> None:
        first = begun.before < 0
        before = begun.before if not first else begun.seq - 1 if self._after is None else self._after
        lost = missed(before, begun.seq, self._unknown)
        self._unknown.clear()
        self._at(time.time_ns(), self._map.seq)
        if first or begun.seq < begun.before:
            known = wording.entities(len(self._map.entities))
            self._recording.note(f"{self._map.seq}  the recording continues from here with {known}")
        self._recall(lost)
        self._related = False
        self._ask_stars()

    def _ask_stars(self) -> None:
        """Ask for the relations; commits that come meanwhile may be newer than they."""
        if self._asking_stars:
            return
        if len(self._map.entities) > MANY_ENTITIES:  # more stars than a message holds
            self._related = True
            self._relations.begin(())
            self._recording.note(f"of more than {MANY_ENTITIES} entities the relations are not drawn")
            self._show_all()
            self._shown()
            return
        self._asking_stars = True

        def on_stars(future: Future[tuple[Star, ...]]) -> None:
            since, self._since_asked, self._asking_stars = self._since_asked, [], False
            if future.exception() is not None:
                return  # it is asked again at the next tick
            self._related = True
            self._relations.begin(future.result())
            for commit in since:
                self._relations.take(commit)
            self._at(time.time_ns(), self._map.seq)
            self._show_all()
            self._shown()

        query = StarQuery(names=tuple(self._map.entities))
        self._node.ask_later(keys.BRIDGE, query).add_done_callback(on_stars)

    def _recall(self, seqs: list[int]) -> None:
        """Record what was committed while nobody listened, and the commit that the recording starts with."""
        for start in range(0, len(seqs), _RECALLED_AT_ONCE):
            some = tuple(seqs[start : start + _RECALLED_AT_ONCE])
            self._node.ask_later(keys.BRIDGE, Recall(seqs=some)).add_done_callback(self._on_recalled)

    def _on_recalled(self, future: Future[tuple[Commit, ...]]) -> None:
        if (error := future.exception()) is not None:
            self._recording.note(f"some commits could not be recorded: {error}", warning=True)
            return
        for commit in future.result():
            self._at(commit.stamp_ns, commit.seq)
            self._recording.commit(commit)

    # The scene

    def _on_poses(self, poses: Poses) -> None:
        self._poses_at = time.monotonic()
        if not self._scene.matches(poses):
            self._fetch_scene()
            return
        self._at(poses.stamp_ns)
        jointed = []
        for name, pose in self._scene.follow(poses):
            self._stage.move(name, pose)
            if self._scene.bodies[name].joints:
                jointed.append(name)
        self._stage.show(jointed, self._map.entities, self._scene.bodies, simulated=True)

    def _on_live(self, live: LivePoses) -> None:
        """Of what is tracked from elsewhere; the simulator's own poses come by themselves."""
        self._at(live.stamp_ns)
        for name, seen in live.entities.items():
            if seen.source == "stream":
                self._stage.move(name, seen.pose)

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
        if self._map.seq >= 0 and not self._related:
            self._ask_stars()
        if self._scene.known and time.monotonic() - self._poses_at > _SCENE_LOST_S:
            self._scene = SceneState()
            self._at(time.time_ns())
            self._show_all()

    def _look_after_the_file(self) -> None:
        """Whoever looks at the status is told of a recording that is not written, for as long as it is so."""
        before, self._amiss = self._amiss, self._growth.amiss(self._recording.logged)
        if self._amiss and not before:
            self._node.report(self._amiss)
        if self._amiss != before:
            self._describe()

    def _tidy(self) -> None:
        """Delete what need not be kept, and let another file be begun when this one is large or old."""
        path, now_s = self._recording.path, time.time()
        by_path = {file.path: file for file in recordings(path.parent)}
        if (current := by_path.pop(path, None)) is None:
            return
        for file in self._keep.surplus(by_path.values(), current, now_s):
            file.path.unlink(missing_ok=True)
            log.info("deleted %s, as --record-keep says", file.path)
        if self._map.seq >= 0 and self._keep.is_full(current, self._begun_s, now_s):
            self.is_full = True
            self._node.stop()

    @property
    def recorded(self) -> int:
        """The last commit that is in the recording."""
        return self._map.seq

    # Both

    def _at(self, stamp_ns: int, seq: int | None = None) -> None:
        """What is recorded from now on is of this time."""
        self._recording.at(max(0, self._map.seq) if seq is None else seq, stamp_ns, self._scene.sim_time_s)

    def _show_all(self) -> None:
        self._stage.show_all(self._map.entities, self._scene.bodies, simulated=self._scene.known)

    def _shown(self, touched: Collection[str] = ()) -> None:
        relations = self._relations.between(self._map.entities)
        self._stage.show_graph(graph_of(self._map.entities, relations, touched))
        if not self._arranged and self._map.entities:
            self._arranged = True
            self._recording.arrange(self._stage.poses)
        self._describe()

    def _describe(self) -> None:
        into = f"into {self._recording.path.name}, {self._live}"
        self._node.ready(f"commit {self._map.seq}, {self._amiss or into}")


def run(config: RecorderConfig) -> int | None:
    """Record until stopped, which is answered with None, or until another file is to be begun.

    Then the answer is the last commit that this one has. Raises BadFile when the file cannot be written.
    """
    serve = config.serve if config.serve is not None and free_to_serve(config.serve) else None
    live = f"live at {serve}" if serve else "no live view"
    if config.serve is not None and serve is None:
        live = f"no live view: {config.serve} is in use"
    with (
        open_node("recorder", config.network) as node,
        open_recording(config.path, serve) as recording,
    ):
        recorder = Recorder(node, recording, live, config.keep, config.after)
        node.run()
        return recorder.recorded if recorder.is_full else None
