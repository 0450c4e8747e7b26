"""From point clouds to observations."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.image_features.image_evidence import ThingImages
from semmap.nodes.perception_node.image_features.photographs import is_photograph
from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.input.masks import Masks
from semmap.nodes.perception_node.recognition.detector_labels import LabelMap
from semmap.nodes.perception_node.recognition.features import features_of
from semmap.nodes.perception_node.recognition.joining import join_parts
from semmap.nodes.perception_node.recognition.recognise import Clutter, recognise
from semmap.nodes.perception_node.recognition.recognition_model import RecognitionModel, shipped
from semmap.nodes.perception_node.recognition.vote import leaf_probabilities
from semmap.nodes.perception_node.tracking.observed_images import NO_IMAGES, ObservedImages
from semmap.nodes.perception_node.views.foot_supports import supports_at_feet
from semmap.nodes.perception_node.views.furniture_planes import join_legs
from semmap.nodes.perception_node.views.fusion import Member, group_segments, same_thing_logits
from semmap.nodes.perception_node.views.masked import with_masks
from semmap.nodes.perception_node.views.merged_thing import Thing, thing_of
from semmap.nodes.perception_node.views.object_supports import supports_of_things
from semmap.nodes.perception_node.views.protrusion import doubts
from semmap.nodes.perception_node.views.segment_memory import Recalled, SegmentMemory, completed
from semmap.nodes.perception_node.views.segmented_view import SegmentedView, segment_cloud
from semmap.nodes.perception_node.views.segments import Segment
from semmap.nodes.perception_node.views.split_segments import resolve_splits
from semmap.nodes.perception_node.views.supports import Support
from semmap.schemas.perception import CameraView, Observation, Observations

__all__ = [
    "FrameResult",
    "RecognitionModel",
    "observe",
    "observe_clouds",
    "observe_views",
    "parts_in",
    "recognise_segments",
    "shipped",
]

_NOTHING = SegmentMemory()


@dataclass(frozen=True)
class FrameResult:
    """The result of one frame: the observations, and for each cloud a label image (H, W).

    In `labels`, 0 is background and n stands for `observations.observations[n - 1]`. `unknown_labels` are
    labels of a detector that match no class. `remembered` is the memory for the next frame. `things` are the
    things of the observations, in the same order. `dropped` are the things that are not reported, with the
    reason. `unused_masks` are the numbers of a detector's masks in each cloud that cover no surface.
    `notes` are doubts about the clouds and their poses. `failures` are the reasons why a detector gave no
    masks. `images` are those of `things`, if their packages are installed and the clouds have colours.
    """

    observations: Observations
    labels: tuple[NDArray[np.int32], ...]
    unknown_labels: tuple[str, ...] = ()
    remembered: SegmentMemory = _NOTHING
    things: tuple[Thing, ...] = ()
    dropped: tuple[tuple[Thing, str], ...] = ()
    unused_masks: tuple[tuple[int, ...], ...] = ()
    notes: tuple[str, ...] = ()
    failures: tuple[str, ...] = ()
    images: ThingImages | None = None

    @property
    def camera_moves(self) -> bool:
        """Return whether a camera of this frame moves."""
        return any(view.camera in self.remembered.moving for view in self.observations.views)

    @property
    def observed_images(self) -> ObservedImages:
        """Return what the network has found in the images of the observations, for tracking."""
        if self.images is None:
            return NO_IMAGES
        known = self.images.known_features(range(len(self.things)))
        return ObservedImages(known, self.images.evidence.classifier.similarities)


def observe(clouds: Sequence[Cloud], learnt: RecognitionModel) -> Observations:
    """Return the observations of clouds taken at the same time, in the map frame; see `observe_clouds`."""
    return observe_clouds(clouds, learnt).observations


def observe_clouds(
    clouds: Sequence[Cloud],
    learnt: RecognitionModel,
    masks: Sequence[Masks | None] = (),
    labels: LabelMap | None = None,
    before: SegmentMemory = _NOTHING,
) -> FrameResult:
    """Find the things in clouds taken at the same time. A thing seen by several cameras is one observation.

    `masks` are the detections of an external detector for each cloud, and `labels` maps their labels to
    classes. Parts that the image edge of a moving camera cuts off are completed from the memory `before`.
    Each cloud is segmented on its own thread, since NumPy and SciPy release the GIL. Raises ValueError for
    masks of another size than the image.
    """
    with ThreadPoolExecutor(max(1, len(clouds))) as threads:
        sights = list(threads.map(_segment_cloud, clouds, [*masks] or [None] * len(clouds)))
    labels = labels or LabelMap(learnt)
    return replace(
        observe_views(sights, learnt, labels, before),
        unknown_labels=labels.unknown(masks),
        unused_masks=tuple(sight.unused_masks for sight in sights),
    )


def _segment_cloud(cloud: Cloud, masks: Masks | None) -> SegmentedView:
    sight = segment_cloud(cloud)
    return sight if masks is None else with_masks(sight, masks)


def observe_views(
    sights: Sequence[SegmentedView],
    learnt: RecognitionModel,
    labels: LabelMap | None = None,
    before: SegmentMemory = _NOTHING,
) -> FrameResult:
    """Find the things in clouds that are segmented already; see `observe_clouds`."""
    parts = parts_in(sights)
    recalled = before.recalled(sights, parts.labels)
    parts = parts.with_foot_supports([s for s in sights if s.cloud.camera in before.moving]).completed(
        recalled
    )
    things, chances, members = join_parts(parts.things, parts.same_thing_logits, learnt, parts.join)
    numbers = [_renumbered(label, members) for label in parts.labels]
    images = images_in([sight.cloud for sight in sights], numbers, len(things), learnt)
    found, reasons = _recognised(sights, numbers, things, chances, learnt, labels, images)
    kept = [n for n, reason in enumerate(reasons) if not reason]
    observations = Observations(
        stamp_ns=max((sight.cloud.stamp_ns for sight in sights), default=0),
        views=tuple(_view(sight) for sight in sights),
        observations=tuple(one for n in kept if isinstance(one := found[n], Observation)),
    )
    elsewhere = [rest for rest, thing in recalled if not thing]
    return FrameResult(
        observations,
        tuple(_renumbered(number, [[n] for n in kept]) for number in numbers),
        remembered=before.after(sights, [thing.segments for thing in things], elsewhere),
        things=tuple(things[n] for n in kept),
        dropped=tuple((things[n], reason) for n, reason in enumerate(reasons) if reason),
        notes=tuple(note for sight in sights for note in sight.notes),
        images=None if images is None else images.select(kept),
    )


def recognise_segments(
    sight: SegmentedView, learnt: RecognitionModel, labels: LabelMap | None = None
) -> dict[int, Observation | None]:
    """Recognise each label of one view by itself; None for clutter and noise. Table tops are omitted."""
    segments = [segment for segment in sight.segments if not segment.carrier]
    if not segments:
        return {}
    things = [thing_of([segment], sight.supports) for segment in segments]
    numbers = _renumbered(sight.labels, [[segment.label - 1] for segment in segments])
    chances = leaf_probabilities(learnt, features_of(things))
    images = images_in([sight.cloud], [numbers], len(things), learnt)
    found, reasons = _recognised([sight], [numbers], things, chances, learnt, labels, images)
    return {
        segment.label: one if isinstance(one, Observation) and not reason else None
        for segment, one, reason in zip(segments, found, reasons, strict=True)
    }


def _recognised(
    sights: Sequence[SegmentedView],
    numbers: Sequence[NDArray[np.int32]],
    things: Sequence[Thing],
    chances: NDArray[np.float64],
    learnt: RecognitionModel,
    labels: LabelMap | None,
    images: ThingImages | None,
) -> tuple[list[Observation | Clutter], list[str]]:
    """Return an observation of each thing, and the reason why it is not reported, or an empty text.

    `numbers`: for each view (H, W) the number of the thing, from 1. `chances`: as for `recognise`.
    """
    found = recognise(things, chances, learnt, labels, images)
    reasons = [
        one.reason if isinstance(one, Clutter) else "" if one.shown else doubt
        for one, doubt in zip(found, doubts(sights, numbers, things), strict=True)
    ]
    return found, reasons


def images_in(
    clouds: Sequence[Cloud],
    numbers: Sequence[NDArray[np.int32]],
    count: int,
    learnt: RecognitionModel,
) -> ThingImages | None:
    """Return the photographs of `count` things; None without any, or without the network.

    `numbers` as for `_recognised`.
    """
    if learnt.images is None:
        return None
    views = [
        (colours, number)
        for cloud, number in zip(clouds, numbers, strict=True)
        if (colours := cloud.colors) is not None and cloud.organised and is_photograph(colours)
    ]
    if not views:
        return None
    return ThingImages(learnt.images, views, tuple(range(1, count + 1)))


def _renumbered(labels: NDArray[np.int32], members: Sequence[Sequence[int]]) -> NDArray[np.int32]:
    """Return labels (H, W) of parts as numbers of things, from 1; `members`: the parts, from 0, of each."""
    numbers = np.zeros(int(labels.max(initial=0)) + 1, np.int32)
    for number, parts in enumerate(members, 1):
        numbers[[part + 1 for part in parts if part + 1 < len(numbers)]] = number
    return numbers[labels]


@dataclass(frozen=True)
class Parts:
    """The things of several views before recognition.

    `labels`: for each view (H, W) the number of the thing, from 1, 0 for none. `same_thing_logits`: (2, N,
    N), see `fusion`. `supports`: surfaces on which things may stand.
    """

    things: list[Thing]
    labels: tuple[NDArray[np.int32], ...]
    same_thing_logits: NDArray[np.float64]
    supports: Sequence[Support]

    def join(self, a: Thing, b: Thing) -> Thing:
        """Return two things merged into one."""
        return thing_of((*a.segments, *b.segments), self.supports)

    def with_foot_supports(self, sights: Sequence[SegmentedView]) -> Parts:
        """Return the parts with additional supports for things that seem to float.

        These are surfaces that the views show around their feet, and the tops of things below. Without views,
        nothing changes.
        """
        if not sights:
            return self
        feet = [*supports_at_feet(sights, self.things), *supports_of_things(self.things)]
        if not feet:
            return self
        supports = [*self.supports, *feet]
        return replace(
            self, things=[thing_of(thing.segments, supports) for thing in self.things], supports=supports
        )

    def completed(self, recalled: Sequence[Recalled]) -> Parts:
        """Complete the things that an image edge cuts from memory."""
        rests: dict[int, list[Segment]] = {}
        for rest, number in recalled:
            if number and not self.things[number - 1].whole:
                rests.setdefault(number - 1, []).append(rest)
        things = list(self.things)
        for n, own in rests.items():
            things[n] = thing_of(completed(things[n].segments, own), self.supports)
        return replace(self, things=things)


def parts_in(sights: Sequence[SegmentedView]) -> Parts:
    """Return the things of several views; segments of one thing in several views are merged."""
    sights = resolve_splits(sights)
    groups = groups_in(sights)
    supports = [support for sight in sights for support in sight.supports]
    things = [thing_of([sights[view].segments[n] for view, n in group], supports) for group in groups]
    return Parts(things, _labels(sights, groups), same_thing_logits(sights, groups), supports)


def groups_in(sights: Sequence[SegmentedView]) -> list[list[Member]]:
    """Return the segments of each thing."""
    groups = group_segments(sights)
    bodies = join_legs([[sights[v].segments[n] for v, n in group] for group in groups])
    return [[member for number in body for member in groups[number]] for body in bodies]


def _labels(
    sights: Sequence[SegmentedView], groups: Sequence[Sequence[Member]]
) -> tuple[NDArray[np.int32], ...]:
    numbers = [np.zeros(int(sight.labels.max(initial=0)) + 1, np.int32) for sight in sights]
    for number, group in enumerate(groups, 1):
        for view, n in group:
            numbers[view][sights[view].segments[n].label] = number
    return tuple(number[sight.labels] for number, sight in zip(numbers, sights, strict=True))


def _view(sight: SegmentedView) -> CameraView:
    cloud = sight.cloud
    height, width = cloud.points_camera.shape[:2]
    return CameraView(
        camera=cloud.camera,
        width=width,
        height=height,
        stamp_ns=cloud.stamp_ns,
        intrinsics=() if cloud.intrinsics is None else tuple(cloud.intrinsics.ravel().tolist()),
        map_from_camera=tuple(sight.map_from_camera.ravel().tolist()),
    )
