"""Map updates: the commands that bring the map in line with the tracks. Pure."""

from __future__ import annotations

import math
from collections.abc import Iterable, Set
from typing import Any

from msgspec import structs

from semmap.nodes.perception_node.config import TrackingConfig
from semmap.nodes.perception_node.tracking.class_hierarchy import ANYTHING, ClassHierarchy
from semmap.nodes.perception_node.tracking.fronts import is_front
from semmap.nodes.perception_node.tracking.overlap import OrientedBox
from semmap.nodes.perception_node.tracking.tracks import Track, slack_m, turn_between
from semmap.schemas.commands import Add, Command, Remove, Update
from semmap.schemas.entities import Entity, Size, distance_m, free_name, rounded
from semmap.schemas.perception import DISPLACED, MISSING

AGENT = "perception_node"

_SURE, _UNSURE = 0.6, 0.25
"""What one class has more and another has less of the votes than, if the one contradicts the other."""
_LEAST_RESIZE_M = 0.015
_BESIDE_M, _LARGE_M = 0.5, 2.0
"""How far beyond a thing that what stands on it may be; how large what is of unknown size may be."""


def subject_of(command: Command) -> str:
    """What a command is about: an entity or, if it is to be a new one, the class."""
    match command:
        case Add():
            return f"a new {command.class_}"
        case Remove():
            return " ".join(command.names)
        case Update():
            return command.name
    raise TypeError(f"perception does not send {type(command).__name__}")


def is_sure(track: Track, classes: ClassHierarchy, config: TrackingConfig) -> bool:
    """Whether a thing was seen at rest often enough to become an entity."""
    if not track.whole:
        return track.frames >= config.part_frames and not track.unseen
    clear = track.votes.share(track.votes.belief(classes), classes) >= config.clear
    enough = config.clear_frames if clear else config.confirm_frames
    return track.frames >= enough and not track.unseen


def additions(tracks: Iterable[Track], taken: Set[str], classes: ClassHierarchy) -> dict[str, Add]:
    """A new entity for each track, in order, by names that are not taken."""
    added: dict[str, Add] = {}
    for track in tracks:
        class_name = track.votes.belief(classes)
        name = free_name(class_name, {*taken, *added})
        pose = rounded(track.pose)
        added[name] = Add(
            source="perception",
            agent=AGENT,
            reason=f"{name} was seen",
            class_=class_name,
            name=name,
            at=pose.position_m,
            orientation=pose.orientation_wxyz,
            size=_to_millimetres(track.size_m),
            ref=classes.label(class_name),
            confidence=_confidence(track, class_name, classes),
        )
    return added


def update_of(
    entity: Entity, track: Track, classes: ClassHierarchy, config: TrackingConfig
) -> Update | Remove | None:
    """What the map must be told of an entity, if anything; what it is only of perception's own."""
    own = is_own(entity)
    if track.is_gone(config):
        return _gone(entity, track, own, config)
    if not track.rests(config.rest_frames):
        return None
    changes: dict[str, Any] = {}
    moved = has_moved(entity, track, config)
    if moved or _is_turned(entity, track):
        corrected = (track.part and track.whole) or track.outsized or _was_front(entity, track)
        enough = config.kept_frames if track.kept else config.nudge_frames
        looks = track.whole_frames if moved else track.frames
        if not track.left and not corrected and looks < enough:
            return None
        pose = rounded(track.reported_pose)
        changes |= {"at": pose.position_m, "orientation": pose.orientation_wxyz}
    class_name = _other_class(entity, track, classes, config)
    if own:
        class_name = class_name or _vaguer_class(entity, track, classes, config)
        changes |= _described(entity, track, class_name, classes, config)
    conflict = "" if own else _conflict(entity, track, class_name, classes)
    if conflict != entity.conflict:
        changes["conflict"] = conflict
    if not changes:
        return None
    reason = f"{entity.name} has moved" if "at" in changes else f"a closer look at {entity.name}"
    confidence = _confidence(track, class_name or track.votes.belief(classes), classes)
    return Update(
        source="perception", agent=AGENT, reason=reason, name=entity.name, confidence=confidence, **changes
    )


def with_load(
    command: Update | Remove | None, entity: Entity, seen: Iterable[Entity]
) -> Update | Remove | None:
    """A move takes along what stands on the thing and cannot be seen; what is seen says itself where it is.

    `seen` are the entities that are seen, or whose places are seen to be filled.
    """
    if not isinstance(command, Update) or command.at is None or entity.pose is None:
        return command
    x, y, z = entity.pose.position_m
    leave = tuple(
        other.name
        for other in seen
        if other.name != entity.name
        and other.pose is not None
        and other.pose.position_m[2] >= z - _BESIDE_M
        and math.dist(other.pose.position_m[:2], (x, y)) <= math.hypot(*_extent(entity)) + _BESIDE_M
    )
    return structs.replace(command, carry=True, leave=leave)


def _extent(entity: Entity) -> tuple[float, float]:
    return entity.size_m[:2] if entity.size_m is not None else (_LARGE_M, _LARGE_M)


def is_own(entity: Entity) -> bool:
    """Whether all that the map says of it is by perception."""
    return {entity.shape_provenance.source, entity.reference_provenance.source} == {"perception"}


def removal_of_leg(name: str, of: str) -> Remove:
    """Of what was an entity before the furniture was seen that it is a leg of."""
    return Remove(source="perception", agent=AGENT, reason=f"{name} is a leg of {of}", names=(name,))


def _gone(entity: Entity, track: Track, own: bool, config: TrackingConfig) -> Update | Remove | None:
    if own and config.when_gone == "remove":
        frames = f"{track.odd or track.unseen} frames in a row"
        found = (
            f"something else was in its place in {frames}"
            if track.odd
            else f"its place was empty in {frames}"
        )
        reason = f"{entity.name} is gone: {found}"
        return Remove(source="perception", agent=AGENT, reason=reason, names=(entity.name,))
    conflict = DISPLACED if track.odd else MISSING
    if entity.conflict == conflict:
        return None
    reason = f"{entity.name}: {conflict}"
    return Update(source="perception", agent=AGENT, reason=reason, name=entity.name, conflict=conflict)


def has_moved(entity: Entity, track: Track, config: TrackingConfig) -> bool:
    """Whether a thing was last seen elsewhere than the map says, or turned."""
    if entity.pose is None:
        return True
    slack = slack_m(track.size_m, config.moved_m)
    return distance_m(entity.pose, track.pose) > slack or turn_between(track, entity.pose) > config.turned_rad


def _is_turned(entity: Entity, track: Track) -> bool:
    """Whether the model of a thing tells another yaw than perception itself told the map."""
    own = entity.pose_provenance is not None and entity.pose_provenance.source == "perception"
    return own and track.fit is not None and entity.pose is not None and track.fit.turned_from(entity.pose)


def _was_front(entity: Entity, track: Track) -> bool:
    """Whether the map has but the front of it."""
    if entity.pose is None or entity.size_m is None:
        return False
    return is_front(OrientedBox(entity.pose, entity.size_m), OrientedBox(track.pose, track.size_m))


def _other_class(entity: Entity, track: Track, classes: ClassHierarchy, config: TrackingConfig) -> str:
    """The class that a thing turns out to be, if that is more special than the map's, or contradicts it."""
    believed = track.votes.belief(classes)
    if track.frames < config.confirm_frames or classes.is_a(entity.class_, believed):
        return ""
    if classes.is_a(believed, entity.class_):
        return believed
    contradicts = (
        track.votes.share(believed, classes) > _SURE and track.votes.share(entity.class_, classes) < _UNSURE
    )
    return believed if contradicts else ""


def _vaguer_class(entity: Entity, track: Track, classes: ClassHierarchy, config: TrackingConfig) -> str:
    """The class above the map's that a thing turns out to be, by looks that no longer bear that out.

    Only one that looks tell from those below it: what is like nothing known, or what perception learnt.
    """
    believed = track.votes.belief(classes)
    tells = believed == ANYTHING or believed in classes.usual_m
    if believed == entity.class_ or not tells or not classes.is_a(entity.class_, believed):
        return ""
    doubted = track.frames >= config.confirm_frames and track.votes.share(entity.class_, classes) < _UNSURE
    return believed if doubted else ""


def _described(
    entity: Entity, track: Track, class_name: str, classes: ClassHierarchy, config: TrackingConfig
) -> dict[str, Any]:
    """What is seen better than before: the class, with what it is called after it, and the size."""
    changes: dict[str, Any] = {}
    if class_name:
        changes["class_"] = class_name
        if entity.preferred_reference == classes.label(entity.class_):
            changes["ref"] = classes.label(class_name)
    if (
        track.whole
        and (track.part or track.outsized or _was_front(entity, track) or track.frames >= config.nudge_frames)
        and _is_resized(entity, track, config)
    ):
        changes["size"] = _to_millimetres(track.size_m)
    return changes


def _is_resized(entity: Entity, track: Track, config: TrackingConfig) -> bool:
    pairs = zip(sorted(entity.size_m or ()), sorted(track.size_m), strict=entity.size_m is not None)
    return entity.size_m is None or any(
        abs(now - before) > max(config.resized * before, _LEAST_RESIZE_M) for before, now in pairs
    )


def _conflict(entity: Entity, track: Track, class_name: str, classes: ClassHierarchy) -> str:
    """What is seen against an operator's word; what was seen before stays until the word is borne out."""
    if class_name and not classes.is_a(class_name, entity.class_):
        return f"looks like a {class_name}"
    confirmed = entity.conflict in (MISSING, DISPLACED) or classes.is_a(
        track.votes.belief(classes), entity.class_
    )
    return "" if confirmed else entity.conflict


def _confidence(track: Track, class_name: str, classes: ClassHierarchy) -> float:
    return round(min(1.0, track.votes.share(class_name, classes)), 3)


def _to_millimetres(size_m: Size) -> Size:
    x, y, z = (max(0.001, round(extent, 3)) for extent in size_m)
    return (x, y, z)
