"""From clouds to observations."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.input.masks import Masks
from semmap.nodes.perception_node.recognition.features import features_of
from semmap.nodes.perception_node.recognition.pieces import put_together
from semmap.nodes.perception_node.recognition.recognise import recognise
from semmap.nodes.perception_node.recognition.shipped_votes import Learnt, shipped
from semmap.nodes.perception_node.recognition.told_names import Labels
from semmap.nodes.perception_node.recognition.vote import leaves
from semmap.nodes.perception_node.views.bases import supports_of_things
from semmap.nodes.perception_node.views.disputes import settled
from semmap.nodes.perception_node.views.feet import supports_at_feet
from semmap.nodes.perception_node.views.furniture_planes import with_what_hangs_below
from semmap.nodes.perception_node.views.fusion import Member, fuse, held_for_one
from semmap.nodes.perception_node.views.masked import with_masks
from semmap.nodes.perception_node.views.merged_thing import Thing, thing_of
from semmap.nodes.perception_node.views.remembered import Recalled, Remembered, completed
from semmap.nodes.perception_node.views.segmented_view import Sight, see
from semmap.nodes.perception_node.views.segments import Segment
from semmap.nodes.perception_node.views.supports import Support
from semmap.schemas.perception import CameraView, Observation, Observations

__all__ = ["Learnt", "Look", "look", "look_at", "observe", "one_by_one", "parts_in", "shipped"]

_NOTHING = Remembered()


@dataclass(frozen=True)
class Look:
    """What one look gave: the observations, and for each cloud (H, W) whose pixel belongs to which of them.

    In `labels` 0 is background and n stands for `observations.observations[n - 1]`. `unknown_labels`: what a
    detector said that is no class here. `remembered` is what the next look is to know of this one and those
    before it. `things`: of which each observation is.
    """

    observations: Observations
    labels: tuple[NDArray[np.int32], ...]
    unknown_labels: tuple[str, ...] = ()
    remembered: Remembered = _NOTHING
    things: tuple[Thing, ...] = ()

    @property
    def on_the_move(self) -> bool:
        """Whether a camera of this look is one that moves."""
        return any(view.camera in self.remembered.moving for view in self.observations.views)


def observe(clouds: Sequence[Cloud], learnt: Learnt) -> Observations:
    """What these clouds, taken at the same time, show in the map frame; see `look`."""
    return look(clouds, learnt).observations


def look(
    clouds: Sequence[Cloud],
    learnt: Learnt,
    masks: Sequence[Masks | None] = (),
    labels: Labels | None = None,
    before: Remembered = _NOTHING,
) -> Look:
    """Find the things that clouds, taken at the same time, show; what several of them see is one thing.

    `masks`: of each cloud what somebody else's detector found in it; `labels`: what its labels mean here.
    What a moving camera's picture cuts off is completed by what was remembered `before`. Each cloud is taken
    apart by a thread of its own: NumPy and SciPy let others work meanwhile. Raises ValueError for masks of
    another size than the picture.
    """
    with ThreadPoolExecutor(max(1, len(clouds))) as threads:
        sights = list(threads.map(_seen, clouds, [*masks] or [None] * len(clouds)))
    labels = labels or Labels(learnt)
    return replace(look_at(sights, learnt, labels, before), unknown_labels=labels.unknown(masks))


def _seen(cloud: Cloud, masks: Masks | None) -> Sight:
    sight = see(cloud)
    return sight if masks is None else with_masks(sight, masks)


def look_at(
    sights: Sequence[Sight], learnt: Learnt, labels: Labels | None = None, before: Remembered = _NOTHING
) -> Look:
    """The same for clouds that were taken apart already."""
    parts = parts_in(sights)
    recalled = before.recalled(sights, parts.labels)
    parts = parts.put_on_feet([s for s in sights if s.cloud.camera in before.moving]).completed(recalled)
    things, chances, members = put_together(parts.things, parts.held_for_one, learnt, parts.join)
    found = recognise(things, chances, learnt, labels)
    kept = [n for n, observation in enumerate(found) if observation is not None]
    observations = Observations(
        stamp_ns=max((sight.cloud.stamp_ns for sight in sights), default=0),
        views=tuple(_view(sight) for sight in sights),
        observations=tuple(observation for observation in found if observation is not None),
    )
    numbers = np.zeros(len(parts.things) + 1, np.int32)
    for number, n in enumerate(kept, 1):
        numbers[np.array(members[n]) + 1] = number
    elsewhere = [rest for rest, thing in recalled if not thing]
    return Look(
        observations,
        tuple(numbers[label] for label in parts.labels),
        remembered=before.after(sights, [thing.segments for thing in things], elsewhere),
        things=tuple(things[n] for n in kept),
    )


def one_by_one(sight: Sight, learnt: Learnt, labels: Labels | None = None) -> dict[int, Observation | None]:
    """What each label of one sight is taken for, by itself; None for clutter. Table tops are left out."""
    segments = [segment for segment in sight.segments if not segment.carrier]
    if not segments:
        return {}
    things = [thing_of([segment], sight.supports) for segment in segments]
    found = recognise(things, leaves(learnt, features_of(things)), learnt, labels)
    return {segment.label: observation for segment, observation in zip(segments, found, strict=True)}


@dataclass(frozen=True)
class Parts:
    """What sights together show, before anything is recognised.

    `labels`: of each sight (H, W) whose a pixel is, counted from 1, 0 for none. `held_for_one`: (2, N, N),
    see `fusion`. `supports`: what things may stand on.
    """

    things: list[Thing]
    labels: tuple[NDArray[np.int32], ...]
    held_for_one: NDArray[np.float64]
    supports: Sequence[Support]

    def join(self, a: Thing, b: Thing) -> Thing:
        """Two of them as one."""
        return thing_of((*a.segments, *b.segments), self.supports)

    def put_on_feet(self, sights: Sequence[Sight]) -> Parts:
        """With what these sights show around the feet of what seems to hang in the air as supports, too.

        And with the tops of things below it. Without sights nothing is asked.
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
        """With what is remembered of those that a picture's edge cuts."""
        rests: dict[int, list[Segment]] = {}
        for rest, number in recalled:
            if number and not self.things[number - 1].whole:
                rests.setdefault(number - 1, []).append(rest)
        things = list(self.things)
        for n, own in rests.items():
            things[n] = thing_of(completed(things[n].segments, own), self.supports)
        return replace(self, things=things)


def parts_in(sights: Sequence[Sight]) -> Parts:
    """What several cameras see of one thing is one part."""
    sights = settled(sights)
    groups = groups_in(sights)
    supports = [support for sight in sights for support in sight.supports]
    things = [thing_of([sights[view].segments[n] for view, n in group], supports) for group in groups]
    return Parts(things, _labels(sights, groups), held_for_one(sights, groups), supports)


def groups_in(sights: Sequence[Sight]) -> list[list[Member]]:
    """The segments of each thing."""
    groups = fuse(sights)
    bodies = with_what_hangs_below([[sights[v].segments[n] for v, n in group] for group in groups])
    return [[member for number in body for member in groups[number]] for body in bodies]


def _labels(sights: Sequence[Sight], groups: Sequence[Sequence[Member]]) -> tuple[NDArray[np.int32], ...]:
    numbers = [np.zeros(int(sight.labels.max(initial=0)) + 1, np.int32) for sight in sights]
    for number, group in enumerate(groups, 1):
        for view, n in group:
            numbers[view][sights[view].segments[n].label] = number
    return tuple(number[sight.labels] for number, sight in zip(numbers, sights, strict=True))


def _view(sight: Sight) -> CameraView:
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
