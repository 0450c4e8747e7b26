"""Perception on the wire: the cameras' frames in, observations and commands out.

Zenoh's threads only keep the newest frames, and a thread of this node's own looks at them. The node's thread
owns the tracks, compares what was seen with the map, and tells the map.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future
from dataclasses import replace
from functools import partial
from typing import Any

from msgspec import structs

from semmap.nodes import bus
from semmap.nodes.perception_node.config import PerceptionConfig
from semmap.nodes.perception_node.fitting.fit import Fit, available
from semmap.nodes.perception_node.fitting.model_surfaces import shipped as shipped_surfaces
from semmap.nodes.perception_node.fitting.tracked import FitToModels, known_fit, known_of, request_fit
from semmap.nodes.perception_node.fitting.worker import FitTo, FitWorker, Request
from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.input.frame_worker import FrameWorker
from semmap.nodes.perception_node.input.masks import Masks
from semmap.nodes.perception_node.lesson_book import LessonBook
from semmap.nodes.perception_node.pipeline import Look, shipped
from semmap.nodes.perception_node.recognition.shipped_votes import Learnt
from semmap.nodes.perception_node.recognition.told_names import Labels
from semmap.nodes.perception_node.segmented_cloud import segmented_cloud
from semmap.nodes.perception_node.teaching import Teaching
from semmap.nodes.perception_node.tracking.association import associate, renamed
from semmap.nodes.perception_node.tracking.class_hierarchy import ANYTHING, ClassHierarchy, hierarchy_of
from semmap.nodes.perception_node.tracking.map_updates import subject_of
from semmap.nodes.perception_node.tracking.occupancy import occupancy_in
from semmap.nodes.perception_node.tracking.tracks import Tracks
from semmap.nodes.perception_node.watching import Watching
from semmap.nodes.runtime.loop import Node, open_node
from semmap.nodes.runtime.map_follower import Follower, SnapshotLoaded
from semmap.nodes.runtime.map_replica import MapReplica
from semmap.schemas import codec, errors, keys, wording
from semmap.schemas.commands import Add, Command, LastSeen
from semmap.schemas.commits import Effects
from semmap.schemas.entities import Size
from semmap.schemas.errors import UnknownName
from semmap.schemas.perception import Observations
from semmap.schemas.replies import Sighting

_COMPLAINT_S = 60.0
"""What is wrong is over when it was not heard of for so long."""
_NO_FRAMES_S = 5.0
_CLOUD_S = 1.0
"""A cloud is published no more often."""
_REFUSED_S = 10.0
"""What was refused is not said again before that."""
_NAMED = 5
"""So many of the classes that nobody knows are named."""
_FAR_M = 3.5
"""Small things that are farther from every camera are hardly found."""


class Perception:
    """Binds the pipeline and the association to the wire."""

    def __init__(
        self,
        node: Node,
        config: PerceptionConfig,
        look: Callable[[Sequence[Cloud], Sequence[Masks | None]], Look],
        usual_m: Mapping[str, Size],
        lessons: LessonBook | None = None,
        taught: Callable[[Learnt], None] = lambda _: None,
        fit: FitTo | None = None,
    ) -> None:
        """`look(clouds, masks)` tells what clouds of one moment, and a detector's masks in them, show.

        `usual_m`: what things of a class measure. `lessons`: what was shown; `taught` is told of each change.
        `fit` aligns a class's model with what is seen of a thing; without it there are no full poses.
        """
        self._node = node
        self._config = config
        self._usual_m = usual_m
        self._map = MapReplica[Effects]()
        self._classes = ClassHierarchy()
        self._tracks = Tracks()
        self._untold = 0
        self._told_commit = 0
        self._refused: dict[str, float] = {}
        self._complaints: dict[str, float] = {}
        self._observations = bus.publisher(node.session, keys.OBSERVATIONS)
        self._cloud_due = 0.0
        self._looked_at = time.monotonic()
        self._cloud = bus.publisher(node.session, keys.CLOUD)
        self._cloud_is_wanted = bus.subscriber_check(node.session, keys.CLOUD)
        Follower(
            node, self._map, keys.EFFECTS, on_commit=lambda commit, known: None, on_snapshot=self._on_map
        )
        node.every(0.5, self._tick)
        self._on_taught = taught
        self._teaching = (
            None if lessons is None else Teaching(node, lessons, lambda: self._classes, self._on_lessons)
        )
        node.follow_newest(keys.DETECTIONS, self._on_detections)
        self._fits = None if fit is None else FitWorker(fit, self._hand_over_fit, self._complain)
        self._worker = FrameWorker(look, self._hand_over, self._complain)
        bus.follow(node.session, keys.MASKS, lambda _, found: self._worker.keep_masks(found))
        for plane in ("rgb", "depth"):
            bus.follow_cameras(node.session, plane, self._worker.keep, self._complain)

    def close(self) -> None:
        """Let the look and the fit in hand be finished, and no other be begun."""
        self._worker.close()
        if self._fits is not None:
            self._fits.close()

    # On the worker's and on Zenoh's threads

    def _hand_over(self, clouds: Sequence[Cloud], found: Look, took_s: float) -> None:
        self._node.soon(lambda: self._on_look(clouds, found, took_s))

    def _hand_over_fit(self, request: Request, found: Fit | None) -> None:
        self._node.soon(lambda: self._on_fit(request, found))

    def _complain(self, text: str) -> None:
        self._node.soon(lambda: self._on_complaint(text))

    # What follows is the node's own thread's

    def _on_complaint(self, text: str) -> None:
        """Say what is wrong: once for as long as it goes on."""
        now = time.monotonic()
        if now - self._complaints.get(text, -math.inf) > _COMPLAINT_S:
            self._node.report(text)
        self._complaints = {said: at for said, at in self._complaints.items() if now - at < _COMPLAINT_S}
        self._complaints[text] = now

    def _on_look(self, clouds: Sequence[Cloud], found: Look, took_s: float) -> None:
        self._looked_at = time.monotonic()
        seen = found.observations
        if found.unknown_labels:
            self._on_complaint(wording.unknown_labels(found.unknown_labels))
        seen = self._compare(seen, clouds, on_the_move=found.on_the_move)
        if self._teaching is not None:
            self._teaching.see(found.things, seen.observations)
        self._ask_for_fit(seen, clouds, found)
        if time.monotonic() >= self._cloud_due and self._cloud_is_wanted():
            self._cloud_due = time.monotonic() + _CLOUD_S
            cloud = segmented_cloud(clouds, found)
            self._cloud.put(codec.encode(cloud), encoding=codec.encoding_of(cloud))
        without = "" if self._fits else "; no full poses without Open3D"
        self._node.describe(summary(clouds, len(seen.observations), took_s) + without)

    def _ask_for_fit(self, seen: Observations, clouds: Sequence[Cloud], found: Look) -> None:
        """Have a thing fitted that rests, and was not since it does."""
        if self._fits is None or self._fits.busy or found.on_the_move:
            return
        request = request_fit(seen, clouds, found, self._tracks, self._config.tracking, self._classes)
        if request is not None:
            self._fits.ask(request)

    def _on_fit(self, request: Request, found: Fit | None) -> None:
        self._tracks = known_fit(self._tracks, request, found, self._config.tracking)

    def _on_detections(self, seen: Observations) -> None:
        """What a detector of one's own has seen; without its picture nothing is known to be gone."""
        unknown = {o.class_ for o in seen.observations} - self._classes.ancestors.keys() - {ANYTHING}
        if unknown and self._classes.ancestors:
            names = ", ".join(sorted(unknown)[:_NAMED])
            self._on_complaint(f"detections of classes that the map does not have were ignored: {names}")
        known = tuple(o for o in seen.observations if o.class_ not in unknown)
        self._compare(structs.replace(seen, observations=known), ())

    def _on_lessons(self, learnt: Learnt) -> None:
        """Something was shown or forgotten: know it from the next look on."""
        self._on_taught(learnt)
        self._usual_m = learnt.usual_m
        self._classes = replace(self._classes, usual_m=self._usual_m)

    def _compare(
        self, seen: Observations, clouds: Sequence[Cloud], *, on_the_move: bool = False
    ) -> Observations:
        """Tell the map what differs, and all others what was seen; `on_the_move`: a camera of these moves.

        Returns what was seen with the entities that it was taken for.
        """
        tracking = self._config.tracking
        if self._map_is_current():
            result = associate(
                self._map.entities,
                self._tracks,
                seen.observations,
                occupancy_in(clouds),
                self._classes,
                tracking.on_the_move if on_the_move else tracking,
            )
            self._tracks = result.tracks
            named = zip(seen.observations, result.entities, strict=True)
            seen = structs.replace(seen, observations=tuple(known_of(o, e, self._tracks) for o, e in named))
            self._tell(result.commands)
        self._observations.put(codec.encode(seen), encoding=codec.encoding_of(seen))
        return seen

    # The map

    def _map_is_current(self) -> bool:
        """Whether the map is known, and has taken all that it was told."""
        return self._map.seq >= self._told_commit and self._map.seq >= 0 and not self._untold

    def _tell(self, commands: Sequence[Command]) -> None:
        now = time.monotonic()
        for command in commands:
            if self._refused.get(subject_of(command), 0.0) < now:
                self._untold += 1
                if isinstance(command, Add):
                    self._add(command)
                else:
                    self._send(command)

    def _add(self, command: Add) -> None:
        """Ask first whether anything was ever called so: names were given before this process began."""
        if command.name is None:
            raise errors.InternalError("a new thing has no name")
        asked = self._node.ask_later(keys.BRIDGE, LastSeen(name=command.name))
        asked.add_done_callback(partial(self._on_sighting, command))

    def _on_sighting(self, command: Add, done: Future[Sighting]) -> None:
        error = done.exception()
        if isinstance(error, UnknownName):
            self._send(command)
        elif error is None:
            self._tracks, command = renamed(self._tracks, command, self._map.entities)
            self._add(command)
        else:
            self._on_told(command, done)

    def _send(self, command: Command) -> None:
        future = self._node.ask_later(keys.CMD, command)
        future.add_done_callback(partial(self._on_told, command))

    def _on_told(self, command: Command, done: Future[Any]) -> None:
        self._untold -= 1
        error = done.exception()
        if error is None:
            self._told_commit = max(self._told_commit, done.result().commit or 0)
            return
        self._refused[subject_of(command)] = time.monotonic() + _REFUSED_S
        self._on_complaint(f"the map rejected an observation: {error}")

    def _on_map(self, begun: SnapshotLoaded) -> None:
        self._classes = hierarchy_of(begun.classes, self._usual_m)
        self._told_commit = min(self._told_commit, self._map.seq)
        self._node.ready("no camera frames yet")

    def _tick(self) -> None:
        if self._map.seq >= 0 and time.monotonic() - self._looked_at > _NO_FRAMES_S:
            self._node.describe("no camera frames received")


def summary(clouds: Sequence[Cloud], things: int, took_s: float) -> str:
    """One look in words; where the cameras are too far from everything, that too."""
    cameras, seen = wording.counted(len(clouds), "camera"), wording.counted(things, "thing")
    near_m = min(cloud.near_m for cloud in clouds)
    far = f"; the nearest surface is {near_m:.1f} m away, use at most 2 m" if near_m > _FAR_M else ""
    return f"{cameras}, {seen} seen, {1000 * took_s:.0f} ms a look{far}"


def run(config: PerceptionConfig) -> None:
    """Look until stopped. Raises BadFile when what perception learnt cannot be read."""
    learnt = shipped()
    lessons = LessonBook(config.lessons, learnt)
    with open_node("perception_node", config.network) as node:
        watching = Watching(learnt, Labels(learnt, config.labels))
        fit = FitToModels(shipped_surfaces()) if available() else None
        perception = Perception(node, config, watching, learnt.usual_m, lessons, watching.take, fit)
        try:
            node.run()
        finally:
            perception.close()
