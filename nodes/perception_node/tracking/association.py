"""Data association: compares observations with the map, and computes commands to update it. Pure.

A frame is matched in steps:

- First, things at or near their old places.
- Then, segments that are a part of a thing in its place, or several such things in one, are ignored, since
  segmentation varies between frames.
- Then, things that vanished are matched with things of the same kind elsewhere, so that identity survives a
  move.
- The remaining observations are new.

The map must apply the commands before the next frame.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

from msgspec import structs

from semmap.nodes.perception_node.config import TrackingConfig
from semmap.nodes.perception_node.tracking.assignment import Candidate, Matching, match
from semmap.nodes.perception_node.tracking.class_hierarchy import ANYTHING, ClassHierarchy
from semmap.nodes.perception_node.tracking.costs import Target, is_complete_despite_cut
from semmap.nodes.perception_node.tracking.legs import is_leg
from semmap.nodes.perception_node.tracking.map_updates import (
    additions,
    has_moved,
    is_own,
    is_sure,
    removal_of_leg,
    update_of,
    with_load,
)
from semmap.nodes.perception_node.tracking.observed_images import NO_IMAGES, ObservedImages
from semmap.nodes.perception_node.tracking.occupancy import OccupancyOf
from semmap.nodes.perception_node.tracking.overlap import (
    OrientedBox,
    may_be_same_thing,
    share,
    uncovered_slabs,
)
from semmap.nodes.perception_node.tracking.tracks import Track, Tracks, slack_m
from semmap.nodes.perception_node.tracking.votes import Votes
from semmap.schemas import errors
from semmap.schemas.commands import Add, Command
from semmap.schemas.entities import Entity, Size, distance_m, free_name
from semmap.schemas.perception import Observation

_ANY_SIZE_M: Size = (0.1, 0.1, 0.1)
_FORGOTTEN_AFTER = 6
"""Consecutive frames without observation after which a tentative track is dropped."""


class Association(NamedTuple):
    """The new tracks, the commands, and the entity of each observation ("" for none yet)."""

    tracks: Tracks
    commands: tuple[Command, ...]
    entities: tuple[str, ...]


def associate(
    entities: Mapping[str, Entity],
    tracks: Tracks,
    observations: Sequence[Observation],
    occupancy_of: OccupancyOf,
    classes: ClassHierarchy,
    config: TrackingConfig,
    images: ObservedImages = NO_IMAGES,
) -> Association:
    """Process one frame. `entities` are of the map; `occupancy_of` returns what is seen of a box.

    `images` are those of the observations.
    """
    candidates = {
        name: _candidate(entity, tracks.known.get(name), classes, config)
        for name, entity in entities.items()
        if not entity.place and entity.pose is not None
    }
    others = [Candidate(track, _target(track, classes)) for track in tracks.tentative]
    matching = match(candidates, others, observations, occupancy_of, classes, config, images)
    known = {
        name: _check_old_place(
            _after(entities[name], candidate, matching, observations, classes, config, images),
            entities[name],
            occupancy_of,
            config,
        )
        for name, candidate in candidates.items()
    }
    tentative = _tentative(tracks.tentative, matching, observations, occupancy_of, config, images)
    stays = [
        entities[name]
        for name in candidates
        if name in matching.known or matching.occupancy[name] == "occupied"
    ]
    boxes = {
        name: OrientedBox(target.pose, target.size_m)
        for name, (_, target) in candidates.items()
        if target.size_m is not None
    }
    legs = {
        name: of
        for name, box in boxes.items()
        if is_own(entities[name]) and (of := _leg_of(box, boxes)) is not None
    }
    updates = [
        removal_of_leg(name, legs[name])
        if name in legs
        else with_load(update_of(entities[name], track, classes, config), entities[name], stays)
        for name, track in known.items()
    ]
    sure = (
        track
        for track in tentative
        if is_sure(track, classes, config) and _leg_of(OrientedBox(track.pose, track.size_m), boxes) is None
    )
    proposed = _without_overlaps(sure)
    added = additions(proposed, {*tracks.names, *entities}, classes)
    names = {j: name for name, j in matching.known.items()}
    new = (replace(track, part=not track.whole) for track in proposed)
    return Association(
        Tracks(
            known | dict(zip(added, new, strict=True)),
            tuple(track for track in tentative if track not in proposed),
            tracks.names.union(added),
        ),
        (*(command for command in updates if command is not None), *added.values()),
        tuple(names.get(j, "") for j in range(len(observations))),
    )


def rename_new_entity(tracks: Tracks, add: Add, entities: Iterable[str]) -> tuple[Tracks, Add]:
    """Choose another name for a new thing, if its name was used before this process started."""
    if add.name is None:
        raise errors.InternalError("a new thing has no name")
    name = free_name(add.class_, tracks.names.union(entities))
    known = {name if old == add.name else old: track for old, track in tracks.known.items()}
    tracks = replace(tracks, known=known, names=tracks.names | {name})
    return tracks, structs.replace(add, name=name, reason=f"{name} was seen")


def _candidate(
    entity: Entity, track: Track | None, classes: ClassHierarchy, config: TrackingConfig
) -> Candidate:
    """Return the candidate of an entity. A pose set by another source since the last frame takes effect.

    The confidence of an earlier process in perception's own entities is stored in the map.
    """
    if entity.pose is None:
        raise errors.InternalError(f"{entity.name} has no pose")
    usual_m = classes.usual_m.get(entity.class_)
    own = entity.shape_provenance.source == "perception"
    if track is None:
        sureness = entity.shape_provenance.confidence if own else None
        votes = Votes() if sureness is None else Votes.remembered(entity.class_, sureness)
        track = Track(entity.pose, entity.size_m or usual_m or _ANY_SIZE_M, votes, map_pose=entity.pose)
    elsewhere = distance_m(track.pose, entity.pose) > slack_m(track.size_m, config.still_m)
    if track.map_pose != entity.pose and elsewhere:
        track = replace(track, pose=entity.pose, frames=0, unseen=0, odd=0, fit=None)
    if track.map_pose != entity.pose:  # the map has changed
        track = replace(track, part=track.part and not track.whole, outsized=False)
    track = replace(track, map_pose=entity.pose, left=track.left and track.map_pose == entity.pose)
    target = _target(track, classes)
    return Candidate(
        track,
        target._replace(
            size_m=track.size_m if track.sized else entity.size_m,
            class_=entity.class_ if target.class_ == ANYTHING else target.class_,
            whole=track.whole or not own,
            usual_m=usual_m,
        ),
    )


def _target(track: Track, classes: ClassHierarchy) -> Target:
    return Target(
        track.pose, track.size_m, track.votes.belief(classes), track.whole, color_rgb=track.color_rgb
    )


def _after(
    entity: Entity,
    candidate: Candidate,
    matching: Matching,
    observations: Sequence[Observation],
    classes: ClassHierarchy,
    config: TrackingConfig,
    images: ObservedImages,
) -> Track:
    """Return the track of an entity after this frame."""
    track, name = candidate.track, entity.name
    if name not in matching.known:
        return track.miss(matching.occupancy[name], odd=name in matching.odd)
    seen, track = observations[matching.known[name]], images.remember(track, matching.known[name])
    mistaken = is_own(entity) and not classes.is_a(track.sized_as, entity.class_)
    if mistaken and is_complete_despite_cut(seen, candidate.target):
        return track.see_all(seen, config)
    if track.is_nearly_odd(config):
        track = replace(track, sized=0, whole=False)  # its previous size is invalid
    return track.see(seen, config)


def _check_old_place(
    track: Track, entity: Entity, occupancy_of: OccupancyOf, config: TrackingConfig
) -> Track:
    """Return the track with a check whether the map's place of the entity is empty."""
    if entity.pose is None or track.unseen or not has_moved(entity, track, config):
        return replace(track, left=False, kept=False)
    before, now = OrientedBox(entity.pose, track.size_m), OrientedBox(track.pose, track.size_m)
    left = track.left or share(now, before) == 0.0 or occupancy_of(*before) == "free"
    whole = OrientedBox(entity.pose, entity.size_m or track.size_m)
    kept = not left and any(occupancy_of(*slab) == "occupied" for slab in uncovered_slabs(whole, now))
    return replace(track, left=left, kept=kept)


def _tentative(
    tracks: Sequence[Track],
    matching: Matching,
    observations: Sequence[Observation],
    occupancy_of: OccupancyOf,
    config: TrackingConfig,
    images: ObservedImages,
) -> list[Track]:
    """Return the tentative tracks, new ones at the end."""
    after = [
        images.remember(track, matching.tentative[i]).see(observations[matching.tentative[i]], config)
        if i in matching.tentative
        else track.overlook(
            visible=config.still_camera or occupancy_of(track.pose, track.size_m) != "unknown"
        )
        for i, track in enumerate(tracks)
    ]
    new = [
        images.remember(Track(observations[j].pose, observations[j].size_m), j).see(observations[j], config)
        for j in matching.new
    ]
    return [*(track for track in after if track.unseen < _FORGOTTEN_AFTER), *new]


def _leg_of(piece: OrientedBox, things: Mapping[str, OrientedBox]) -> str | None:
    """Return the name of the thing of which a piece is a leg."""
    return next((name for name, thing in things.items() if is_leg(piece, thing)), None)


def _without_overlaps(tracks: Iterable[Track]) -> list[Track]:
    apart: list[Track] = []
    for track in tracks:
        box = OrientedBox(track.pose, track.size_m)
        if not any(may_be_same_thing(box, OrientedBox(other.pose, other.size_m)) for other in apart):
            apart.append(track)
    return apart
