"""From clouds to observations."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nodes.perception_node.cloud import Cloud
from nodes.perception_node.fusion import fuse
from nodes.perception_node.recognition.learnt import Learnt, shipped
from nodes.perception_node.recognition.recognise import recognise
from nodes.perception_node.sights import Sight, see
from nodes.perception_node.things import Thing, thing_of
from schemas.perception import CameraView, Observations

__all__ = ["Learnt", "Look", "look", "look_at", "observe", "shipped", "things_in"]


@dataclass(frozen=True)
class Look:
    """What one look gave: the observations, and for each cloud (H, W) whose pixel belongs to which of them.

    In `labels` 0 is background and n stands for `observations.observations[n - 1]`.
    """

    observations: Observations
    labels: tuple[NDArray[np.int32], ...]


def observe(clouds: Sequence[Cloud], learnt: Learnt) -> Observations:
    """What these clouds, taken at the same time, show in the map frame; see `look`."""
    return look(clouds, learnt).observations


def look(clouds: Sequence[Cloud], learnt: Learnt) -> Look:
    """Find the things that clouds, taken at the same time, show; what several of them see is one thing."""
    return look_at([see(cloud) for cloud in clouds], learnt)


def look_at(sights: Sequence[Sight], learnt: Learnt) -> Look:
    """The same for clouds that were taken apart already."""
    things, labels = things_in(sights)
    found = recognise(things, learnt)
    numbers = np.zeros(len(found) + 1, np.int32)
    numbers[1:] = np.cumsum([observation is not None for observation in found])
    numbers[1:][[observation is None for observation in found]] = 0
    observations = Observations(
        stamp_ns=max((sight.cloud.stamp_ns for sight in sights), default=0),
        views=tuple(_view(sight) for sight in sights),
        observations=tuple(observation for observation in found if observation is not None),
    )
    return Look(observations, tuple(numbers[label] for label in labels))


def things_in(sights: Sequence[Sight]) -> tuple[list[Thing], tuple[NDArray[np.int32], ...]]:
    """What all sights together show, and for each (H, W) whose a pixel is, counted from 1, 0 for none."""
    groups = fuse(sights)
    supports = [height for sight in sights for height in sight.supports_m]
    numbers = [np.zeros(int(sight.labels.max(initial=0)) + 1, np.int32) for sight in sights]
    things = []
    for number, group in enumerate(groups, 1):
        segments = [sights[view].segments[n] for view, n in group]
        things.append(thing_of(segments, supports))
        for (view, _), segment in zip(group, segments, strict=True):
            numbers[view][segment.label] = number
    return things, tuple(number[sight.labels] for number, sight in zip(numbers, sights, strict=True))


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
