"""Which of the things that a look shows can be fitted, and what a fit tells of one."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from msgspec import structs

from semmap.nodes.perception_node.fitting.fit import Fit, fit_models
from semmap.nodes.perception_node.fitting.model_surfaces import ClassSurfaces
from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.pipeline import FrameResult
from semmap.nodes.perception_node.recognition.recognition_model import UNKNOWN
from semmap.nodes.perception_node.views.boxes import Numbers
from semmap.nodes.perception_node.views.segmented_view import SegmentedView
from semmap.nodes.perception_node.views.segments import map_points
from semmap.schemas import errors
from semmap.schemas.entities import Pose, Size
from semmap.schemas.perception import Observation

_LONG = 1.3
"""What is so much longer than wide has a direction of its own, from which its model must not stray."""
_STRAYED_RAD = math.radians(20.0)


def with_poses(clouds: Sequence[Cloud], found: FrameResult) -> list[Cloud]:
    """The clouds with the poses that the look has taken for theirs."""
    views = found.observations.views
    return [
        replace(cloud, map_from_camera=np.array(view.map_from_camera).reshape(4, 4))
        for cloud, view in zip(clouds, views, strict=True)
    ]


def points_of(number: int, clouds: Sequence[Cloud], found: FrameResult) -> Numbers:
    """(N, 3) what clouds, `posed`, show of the n-th thing of a look, counted from 1; map frame [m]."""
    seen = []
    for cloud, labels in zip(clouds, found.labels, strict=True):
        if cloud.map_from_camera is None:
            raise errors.InternalError("the pose of the camera is unknown")
        points = map_points(
            replace(cloud, points_camera=cloud.points_camera[labels == number]), cloud.map_from_camera
        )
        seen.append(points[np.isfinite(points).all(axis=1)])
    return np.concatenate(seen).astype(float)


def fit_all(clouds: Sequence[Cloud], found: FrameResult, surfaces: ClassSurfaces) -> tuple[Observation, ...]:
    """The observations of a look, each with what its fit tells."""
    clouds = with_poses(clouds, found)
    return tuple(
        with_fit(seen, fit_of(seen, points_of(n, clouds, found), clouds, surfaces))
        for n, seen in enumerate(found.observations.observations, 1)
    )


def fit_view(
    sight: SegmentedView, told: Mapping[int, Observation | None], surfaces: ClassSurfaces
) -> dict[int, Observation | None]:
    """What each label of one sight is taken for, with what its fit tells."""
    clouds = [replace(sight.cloud, map_from_camera=sight.map_from_camera)]
    points = {segment.label: segment.points.astype(float) for segment in sight.segments}
    return {
        label: None if seen is None else with_fit(seen, fit_of(seen, points[label], clouds, surfaces))
        for label, seen in told.items()
    }


def fit_of(
    seen: Observation, points: Numbers, clouds: Sequence[Cloud], surfaces: ClassSurfaces
) -> Fit | None:
    """The model of its class aligned with what was seen of a thing.

    None without a model, where too little was seen, and for a pose across the box.
    """
    models = surfaces.get(seen.class_)
    if not models:
        return None
    found = fit_models(seen.class_, models, points, seen.pose, seen.size_m, clouds)
    if found is None or lies_across(found, seen.pose, seen.size_m):
        return None
    return found


def lies_across(found: Fit, pose: Pose, size_m: Size) -> bool:
    """Whether a fit has an upright model lie across the long box that was seen."""
    x, y, _ = size_m
    if found.lying or max(x, y) < _LONG * min(x, y) or found.fold in (0, 4):
        return False
    across = math.pi / 2.0 if (x > y) != (found.size_m[0] > found.size_m[1]) else 0.0
    turn = math.remainder(found.pose.yaw_rad - pose.yaw_rad - across, math.pi)
    return abs(turn) > _STRAYED_RAD


def with_fit(seen: Observation, found: Fit | None) -> Observation:
    """The observation with what its fit tells: orientation and size, or that it is not of that class.

    What is not seen whole is not told to be of another class: its box is a guess, and the model has its size.
    Nor is what was shown: it may look unlike the model that its class has.
    """
    if found is None:
        return seen
    if contradicts_class(seen, found):
        return structs.replace(seen, class_=UNKNOWN, fit=found.score)
    if not found.has_orientation:
        return structs.replace(seen, fit=found.score)
    if found.lying:
        return structs.replace(seen, pose=found.pose, size_m=found.size_m, fit=found.score)
    size_m = size_along(found.pose.yaw_rad - seen.pose.yaw_rad, seen.size_m)
    pose = structs.replace(seen.pose, orientation_wxyz=found.pose.orientation_wxyz)
    return structs.replace(seen, pose=pose, size_m=size_m, fit=found.score)


def contradicts_class(seen: Observation, found: Fit) -> bool:
    """Whether a fit takes an observation's name back."""
    return seen.whole and not seen.shown and not found.is_verified


def size_along(turn_rad: float, size_m: Size) -> Size:
    """The extents of a box along axes that are turned by this, to the nearest quarter."""
    x, y, z = size_m
    return (y, x, z) if round(turn_rad / (math.pi / 2.0)) % 2 else (x, y, z)
