"""Fits models to tracked things: selects the next thing, and applies the result."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from msgspec import structs

from semmap.nodes.perception_node.config import TrackingConfig
from semmap.nodes.perception_node.fitting.fit import Fit
from semmap.nodes.perception_node.fitting.fit_observations import (
    contradicts_class,
    fit_of,
    points_of,
    size_along,
    with_poses,
)
from semmap.nodes.perception_node.fitting.model_surfaces import ClassSurfaces
from semmap.nodes.perception_node.fitting.worker import Request
from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.pipeline import FrameResult
from semmap.nodes.perception_node.tracking.class_hierarchy import ANYTHING, ClassHierarchy
from semmap.nodes.perception_node.tracking.fits import KnownFit
from semmap.nodes.perception_node.tracking.tracks import Track, Tracks, slack_m
from semmap.schemas.entities import Pose, distance_m
from semmap.schemas.perception import Observation, Observations

_LONG = 1.3


@dataclass(frozen=True)
class FitToModels:
    """Fits requested things to the models of their classes."""

    surfaces: ClassSurfaces

    def __call__(self, request: Request) -> Fit | None:
        """Return the fit of one thing, or None."""
        clouds = with_poses(request.clouds, request.found)
        points = points_of(request.number, clouds, request.found)
        return fit_of(request.seen, points, clouds, self.surfaces)


def request_fit(
    seen: Observations,
    clouds: Sequence[Cloud],
    found: FrameResult,
    tracks: Tracks,
    config: TrackingConfig,
    classes: ClassHierarchy,
) -> Request | None:
    """Return a request for the first entity that was seen whole, rests, and has no current fit."""
    if len(seen.views) != len(clouds):
        return None
    for number, one in enumerate(seen.observations, 1):
        track = tracks.known.get(one.entity)
        if track is None or not one.whole or not track.rests(config.rest_frames):
            continue
        if one.class_ in (ANYTHING, track.rejected_class) or track.votes.belief(classes) != one.class_:
            continue
        if track.fit is None or track.fit.class_ != one.class_:
            own = found.observations.observations[number - 1]  # as its box was seen
            return Request(one.entity, track.pose, own, number, clouds, found)
    return None


def apply_fit(tracks: Tracks, request: Request, found: Fit | None, config: TrackingConfig) -> Tracks:
    """Return the tracks with the result of a fit. If the thing moved since, the result is dropped."""
    track = tracks.known.get(request.name)
    if track is None or distance_m(track.pose, request.box) > slack_m(track.size_m, config.still_m):
        return tracks
    fit = KnownFit(request.seen.class_, 0.0, None, 0)
    if found is not None:
        usable = found.has_orientation and not found.lying and not _across(found.pose, track)
        fit = KnownFit(found.class_, found.score, found.pose.orientation_wxyz if usable else None, found.fold)
    rejected = found is not None and contradicts_class(request.seen, found)
    return replace(tracks, known={**tracks.known, request.name: track.fitted(fit, rejected=rejected)})


def with_known_fit(seen: Observation, entity: str, tracks: Tracks) -> Observation:
    """Return an observation with its entity, and the entity's fitted orientation."""
    track = tracks.known.get(entity)
    if track is None or track.fit is None or track.fit.orientation_wxyz is None:
        return structs.replace(seen, entity=entity)
    pose = Pose(position_m=seen.pose.position_m, orientation_wxyz=track.fit.orientation_wxyz)
    size_m = size_along(pose.yaw_rad - seen.pose.yaw_rad, seen.size_m)
    return structs.replace(seen, entity=entity, pose=pose, size_m=size_m, fit=track.fit.score)


def _across(pose: Pose, track: Track) -> bool:
    """Return whether a model's x axis is across a long box, so that the size would be swapped."""
    x, y, _ = track.size_m
    quarters = round((pose.yaw_rad - track.pose.yaw_rad) / (math.pi / 2.0))
    return max(x, y) > _LONG * min(x, y) and quarters % 2 == 1
