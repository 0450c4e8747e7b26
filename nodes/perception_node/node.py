"""The perception node: subscribes to camera frames, publishes observations and sends commands.

Zenoh's threads only store the newest frames. A worker thread processes them. The node's thread owns the
tracks, compares observations with the map and updates it.
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
from semmap.nodes.perception_node.detection.detector_model import DetectorModel
from semmap.nodes.perception_node.exemplar_commands import ExemplarCommands
from semmap.nodes.perception_node.exemplar_store import ExemplarStore
from semmap.nodes.perception_node.fitting.fit import Fit, available
from semmap.nodes.perception_node.fitting.fit_tracks import (
    FitToModels,
    apply_fit,
    request_fit,
    with_known_fit,
)
from semmap.nodes.perception_node.fitting.model_surfaces import shipped as shipped_surfaces
from semmap.nodes.perception_node.fitting.worker import FitTo, FitWorker, Request
from semmap.nodes.perception_node.image_features.image_evidence import with_images
from semmap.nodes.perception_node.image_features.network import available as images_are_available
from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.input.frame_worker import FrameWorker
from semmap.nodes.perception_node.input.live_robot import LiveRobot
from semmap.nodes.perception_node.input.masks import Masks
from semmap.nodes.perception_node.observer import Observer
from semmap.nodes.perception_node.pipeline import FrameResult, shipped
from semmap.nodes.perception_node.recognition.detector_labels import LabelMap
from semmap.nodes.perception_node.recognition.recognition_model import RecognitionModel
from semmap.nodes.perception_node.segmented_cloud import segmented_cloud
from semmap.nodes.perception_node.tracking.association import associate, rename_new_entity
from semmap.nodes.perception_node.tracking.class_hierarchy import ANYTHING, ClassHierarchy, hierarchy_of
from semmap.nodes.perception_node.tracking.map_updates import subject_of
from semmap.nodes.perception_node.tracking.observed_images import NO_IMAGES, ObservedImages
from semmap.nodes.perception_node.tracking.occupancy import occupancy_in
from semmap.nodes.perception_node.tracking.tracks import Tracks
from semmap.nodes.runtime.loop import Node, open_node
from semmap.nodes.runtime.map_follower import Follower, SnapshotLoaded
from semmap.nodes.runtime.map_replica import MapReplica
from semmap.schemas import codec, errors, keys, wording
from semmap.schemas.commands import Add, Command, LastSeen
from semmap.schemas.commits import Effects
from semmap.schemas.entities import ClassInfo, Size
from semmap.schemas.errors import UnknownName
from semmap.schemas.perception import Observations
from semmap.schemas.replies import Sighting

_COMPLAINT_S = 60.0
"""A problem is over if it was not reported for this long."""
_NO_FRAMES_S = 5.0
_CLOUD_S = 1.0
"""Minimum time between two published clouds."""
_REFUSED_S = 10.0
"""A rejected command is not repeated before this time."""
_NAMED = 5
"""Maximum number of unknown classes in a message."""
_FAR_M = 3.5
"""Small things beyond this distance from every camera are rarely found."""


class Perception:
    """Connects the pipeline and the tracking to the network."""

    def __init__(
        self,
        node: Node,
        config: PerceptionConfig,
        look: Callable[[Sequence[Cloud], Sequence[Masks | None]], FrameResult],
        usual_m: Mapping[str, Size],
        exemplars: ExemplarStore | None = None,
        taught: Callable[[RecognitionModel], None] = lambda _: None,
        fit: FitTo | None = None,
        on_classes: Callable[[Sequence[ClassInfo]], None] = lambda _: None,
        robot: LiveRobot | None = None,
    ) -> None:
        """Register subscribers and start the worker threads.

        `look(clouds, masks)` processes the clouds of one moment and a detector's masks. `usual_m` are the
        typical sizes of classes. `taught` is called when the exemplars change. `fit` aligns the model of a
        class with a thing; without it, there are no full poses. `on_classes` is called with the classes of
        each snapshot of the map. `robot` is left out of all clouds.
        """
        self._node = node
        self._config = config
        self._usual_m = usual_m
        self._on_classes = on_classes
        self._map = MapReplica[Effects]()
        self._classes = ClassHierarchy()
        self._tracks = Tracks()
        self._pending = 0
        self._sent_commit = 0
        self._refused: dict[str, float] = {}
        self._complaints: dict[str, float] = {}
        self._observations = bus.publisher(node.session, keys.OBSERVATIONS)
        self._cloud_due = 0.0
        self._frame_time = time.monotonic()
        self._cloud = bus.publisher(node.session, keys.CLOUD)
        self._cloud_is_wanted = bus.subscriber_check(node.session, keys.CLOUD)
        Follower(
            node, self._map, keys.EFFECTS, on_commit=lambda commit, known: None, on_snapshot=self._on_map
        )
        node.every(0.5, self._tick)
        self._on_taught = taught
        self._exemplar_commands = (
            None
            if exemplars is None
            else ExemplarCommands(node, exemplars, lambda: self._classes, self._on_exemplars)
        )
        node.follow_newest(keys.DETECTIONS, self._on_detections)
        self._fits = None if fit is None else FitWorker(fit, self._forward_fit, self._complain)
        self._worker = FrameWorker(look, self._forward, self._complain, robot)
        if robot is not None:
            states = keys.ROBOT_STATE._replace(key=robot.key)
            bus.follow(node.session, states, lambda _, state: robot.keep(state))
        bus.follow(node.session, keys.MASKS, lambda _, found: self._worker.keep_masks(found))
        for plane in ("rgb", "depth"):
            bus.follow_cameras(node.session, plane, self._worker.keep, self._complain)

    def close(self) -> None:
        """Finish the current frame and the current fit, and stop the workers."""
        self._worker.close()
        if self._fits is not None:
            self._fits.close()

    # On the worker's and on Zenoh's threads

    def _forward(self, clouds: Sequence[Cloud], found: FrameResult, took_s: float) -> None:
        self._node.soon(lambda: self._on_frame(clouds, found, took_s))

    def _forward_fit(self, request: Request, found: Fit | None) -> None:
        self._node.soon(lambda: self._on_fit(request, found))

    def _complain(self, text: str) -> None:
        self._node.soon(lambda: self._on_complaint(text))

    # On the node's thread

    def _on_complaint(self, text: str) -> None:
        """Report a problem, once for as long as it lasts."""
        now = time.monotonic()
        if now - self._complaints.get(text, -math.inf) > _COMPLAINT_S:
            self._node.report(text)
        self._complaints = {old: at for old, at in self._complaints.items() if now - at < _COMPLAINT_S}
        self._complaints[text] = now

    def _on_frame(self, clouds: Sequence[Cloud], found: FrameResult, took_s: float) -> None:
        self._frame_time = time.monotonic()
        seen = found.observations
        if found.unknown_labels:
            self._on_complaint(wording.unknown_labels(found.unknown_labels))
        for text in found.failures:
            self._on_complaint(text)
        seen = self._compare(seen, clouds, camera_moves=found.camera_moves, images=found.observed_images)
        if self._exemplar_commands is not None:
            self._exemplar_commands.see(found, seen.observations)
        self._ask_for_fit(seen, clouds, found)
        if time.monotonic() >= self._cloud_due and self._cloud_is_wanted():
            self._cloud_due = time.monotonic() + _CLOUD_S
            cloud = segmented_cloud(clouds, found)
            self._cloud.put(codec.encode(cloud), encoding=codec.encoding_of(cloud))
        without = "" if self._fits else "; no full poses without Open3D"
        without += "" if images_are_available() else "; no image features without onnxruntime"
        if self._config.detector is not None:
            without += f"; detector {self._config.detector.model.name}"
        self._node.describe(summary(clouds, len(seen.observations), took_s) + without)

    def _ask_for_fit(self, seen: Observations, clouds: Sequence[Cloud], found: FrameResult) -> None:
        """Request a fit of a thing that rests and was not fitted since."""
        if self._fits is None or self._fits.busy or found.camera_moves:
            return
        request = request_fit(seen, clouds, found, self._tracks, self._config.tracking, self._classes)
        if request is not None:
            self._fits.ask(request)

    def _on_fit(self, request: Request, found: Fit | None) -> None:
        self._tracks = apply_fit(self._tracks, request, found, self._config.tracking)

    def _on_detections(self, seen: Observations) -> None:
        """Process observations of an external detector. Without its image, absence cannot be concluded."""
        unknown = {o.class_ for o in seen.observations} - self._classes.ancestors.keys() - {ANYTHING}
        if unknown and self._classes.ancestors:
            names = ", ".join(sorted(unknown)[:_NAMED])
            self._on_complaint(f"detections of classes that the map does not have were ignored: {names}")
        known = tuple(o for o in seen.observations if o.class_ not in unknown)
        self._compare(structs.replace(seen, observations=known), ())

    def _on_exemplars(self, learnt: RecognitionModel) -> None:
        """Use the changed exemplars from the next frame on."""
        self._on_taught(learnt)
        self._usual_m = learnt.usual_m
        self._classes = replace(self._classes, usual_m=self._usual_m)

    def _compare(
        self,
        seen: Observations,
        clouds: Sequence[Cloud],
        *,
        camera_moves: bool = False,
        images: ObservedImages = NO_IMAGES,
    ) -> Observations:
        """Update the map from observations and publish them; `camera_moves`: a camera of these moves.

        Returns the observations with their entities.
        """
        tracking = self._config.tracking
        if self._map_is_current():
            result = associate(
                self._map.entities,
                self._tracks,
                seen.observations,
                occupancy_in(clouds),
                self._classes,
                tracking.for_moving_camera if camera_moves else tracking,
                images,
            )
            self._tracks = result.tracks
            named = zip(seen.observations, result.entities, strict=True)
            seen = structs.replace(
                seen, observations=tuple(with_known_fit(o, e, self._tracks) for o, e in named)
            )
            self._send_all(result.commands)
        self._observations.put(codec.encode(seen), encoding=codec.encoding_of(seen))
        return seen

    # The map

    def _map_is_current(self) -> bool:
        """Return whether the map is known and has applied all pending commands."""
        return self._map.seq >= self._sent_commit and self._map.seq >= 0 and not self._pending

    def _send_all(self, commands: Sequence[Command]) -> None:
        now = time.monotonic()
        for command in commands:
            if self._refused.get(subject_of(command), 0.0) < now:
                self._pending += 1
                if isinstance(command, Add):
                    self._add(command)
                else:
                    self._send(command)

    def _add(self, command: Add) -> None:
        """Check first that the name was never used: names may date from before this process started."""
        if command.name is None:
            raise errors.InternalError("a new thing has no name")
        reply = self._node.ask_later(keys.BRIDGE, LastSeen(name=command.name))
        reply.add_done_callback(partial(self._on_sighting, command))

    def _on_sighting(self, command: Add, done: Future[Sighting]) -> None:
        error = done.exception()
        if isinstance(error, UnknownName):
            self._send(command)
        elif error is None:
            self._tracks, command = rename_new_entity(self._tracks, command, self._map.entities)
            self._add(command)
        else:
            self._on_reply(command, done)

    def _send(self, command: Command) -> None:
        future = self._node.ask_later(keys.CMD, command)
        future.add_done_callback(partial(self._on_reply, command))

    def _on_reply(self, command: Command, done: Future[Any]) -> None:
        self._pending -= 1
        error = done.exception()
        if error is None:
            self._sent_commit = max(self._sent_commit, done.result().commit or 0)
            return
        self._refused[subject_of(command)] = time.monotonic() + _REFUSED_S
        self._on_complaint(f"the map rejected an observation: {error}")

    def _on_map(self, begun: SnapshotLoaded) -> None:
        self._classes = hierarchy_of(begun.classes, self._usual_m)
        self._on_classes(begun.classes)
        self._sent_commit = min(self._sent_commit, self._map.seq)
        self._node.ready("no camera frames yet")

    def _tick(self) -> None:
        if self._map.seq >= 0 and time.monotonic() - self._frame_time > _NO_FRAMES_S:
            self._node.describe("no camera frames received")


def summary(clouds: Sequence[Cloud], things: int, took_s: float) -> str:
    """Describe one frame, with a note if the cameras are too far from everything."""
    cameras, seen = wording.counted(len(clouds), "camera"), wording.counted(things, "thing")
    near_m = min(cloud.near_m for cloud in clouds)
    far = f"; the nearest surface is {near_m:.1f} m away, use at most 2 m" if near_m > _FAR_M else ""
    return f"{cameras}, {seen} seen, {1000 * took_s:.0f} ms per frame{far}"


def run(config: PerceptionConfig) -> None:
    """Run the node until it is stopped. Raises BadFile if a model of perception cannot be read."""
    learnt = with_images(shipped(), live=True)
    exemplars = ExemplarStore(config.lessons, learnt)
    detector = None
    if (of := config.detector) is not None:
        detector = DetectorModel(of.model, of.names, of.layout, of.least_score)
    robot = None if config.robot is None else LiveRobot(config.robot.name, config.robot.model)
    with open_node("perception_node", config.network) as node:
        observer = Observer(learnt, LabelMap(learnt, config.labels), detector)
        fit = FitToModels(shipped_surfaces()) if available() else None
        perception = Perception(
            node,
            config,
            observer,
            learnt.usual_m,
            exemplars,
            observer.set_model,
            fit,
            lambda classes: observer.set_labels(LabelMap(learnt, config.labels, classes)),
            robot,
        )
        try:
            node.run()
        finally:
            perception.close()
