"""Fits models to the things of a frame, and applies the results to observations."""

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
"""A thing longer than wide by this factor has a direction, which its model must match."""
_STRAYED_RAD = math.radians(20.0)


def with_poses(clouds: Sequence[Cloud], found: FrameResult) -> list[Cloud]:
    """Return the clouds with the camera poses used for the frame."""
    views = found.observations.views
    return [
        replace(cloud, map_from_camera=np.array(view.map_from_camera).reshape(4, 4))
        for cloud, view in zip(clouds, views, strict=True)
    ]


def points_of(number: int, clouds: Sequence[Cloud], found: FrameResult) -> Numbers:
    """Return points (N, 3) of the n-th thing of a frame, from 1, in the map frame [m].

    Needs clouds with poses, see `with_poses`.
    """
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
    """Return the observations of a frame, each updated by its fit."""
    clouds = with_poses(clouds, found)
    return tuple(
        with_fit(seen, fit_of(seen, points_of(n, clouds, found), clouds, surfaces))
        for n, seen in enumerate(found.observations.observations, 1)
    )


def fit_view(
    sight: SegmentedView, found: Mapping[int, Observation | None], surfaces: ClassSurfaces
) -> dict[int, Observation | None]:
    """Return the observation of each label of one view, updated by its fit."""
    clouds = [replace(sight.cloud, map_from_camera=sight.map_from_camera)]
    points = {segment.label: segment.points.astype(float) for segment in sight.segments}
    return {
        label: None if seen is None else with_fit(seen, fit_of(seen, points[label], clouds, surfaces))
        for label, seen in found.items()
    }


def fit_of(
    seen: Observation, points: Numbers, clouds: Sequence[Cloud], surfaces: ClassSurfaces
) -> Fit | None:
    """Align the model of the observation's class with a thing.

    Returns None without a model, with too few points, or if the model lies across the box.
    """
    models = surfaces.get(seen.class_)
    if not models:
        return None
    found = fit_models(seen.class_, models, points, seen.pose, seen.size_m, clouds)
    if found is None or lies_across(found, seen.pose, seen.size_m):
        return None
    return found


def lies_across(found: Fit, pose: Pose, size_m: Size) -> bool:
    """Return whether an upright model lies across a long observed box."""
    x, y, _ = size_m
    if found.lying or max(x, y) < _LONG * min(x, y) or found.fold in (0, 4):
        return False
    across = math.pi / 2.0 if (x > y) != (found.size_m[0] > found.size_m[1]) else 0.0
    turn = math.remainder(found.pose.yaw_rad - pose.yaw_rad - across, math.pi)
    return abs(turn) > _STRAYED_RAD


def with_fit(seen: Observation, found: Fit | None) -> Observation:
    """Return the observation updated by its fit: orientation and size, or that its class is wrong.

    The class of a partly visible thing is not rejected, because its box is an estimate. Neither is that of an
    exemplar, which may look unlike the model of its class.
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
    """Return whether a fit rejects the class of an observation."""
    return seen.whole and not seen.shown and not found.is_verified


def size_along(turn_rad: float, size_m: Size) -> Size:
    """Return the extents of a box along axes rotated by an angle, to the nearest quarter turn."""
    x, y, z = size_m
    return (y, x, z) if round(turn_rad / (math.pi / 2.0)) % 2 else (x, y, z)
