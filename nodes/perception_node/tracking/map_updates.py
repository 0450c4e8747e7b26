"""Map updates: the commands that update the map from the tracks. Pure."""

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
"""One class contradicts another if it has more, and the other less, of the votes than these."""
_LEAST_RESIZE_M = 0.015
_BESIDE_M, _LARGE_M = 0.5, 2.0
"""Distance from a thing within which others may stand on it, and the size of a thing of unknown size."""


def subject_of(command: Command) -> str:
    """Return the subject of a command: an entity or, for a new one, the class."""
    match command:
        case Add():
            return f"a new {command.class_}"
        case Remove():
            return " ".join(command.names)
        case Update():
            return command.name
    raise TypeError(f"perception does not send {type(command).__name__}")


def is_sure(track: Track, classes: ClassHierarchy, config: TrackingConfig) -> bool:
    """Return whether a thing was seen at rest often enough, and missed seldom enough, to become an entity.

    A thing of no known class that an image edge cuts is not sure: most are pieces of walls and furniture.
    """
    believed = track.votes.belief(classes)
    clear = track.votes.share(believed, classes) >= config.clear
    enough = config.clear_frames if clear else config.confirm_frames
    if not track.whole:
        enough = config.part_frames
    vague = believed == ANYTHING and not track.label
    agreeing = max(enough, config.vague_frames) if vague else enough
    seen = track.frames >= enough and track.agreement >= agreeing and not track.unseen
    return seen and (track.whole or not vague)


def additions(tracks: Iterable[Track], taken: Set[str], classes: ClassHierarchy) -> dict[str, Add]:
    """Return the command to add each track, in order, with unused names."""
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
            ref=track.label or classes.label(class_name),
            confidence=_confidence(track, class_name, classes),
        )
    return added


def update_of(
    entity: Entity, track: Track, classes: ClassHierarchy, config: TrackingConfig
) -> Update | Remove | None:
    """Return the command that updates an entity, if any.

    Class and size are only changed for perception's own entities.
    """
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
        frames = track.whole_frames if moved else track.frames
        if not track.left and not corrected and frames < enough:
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
    reason = f"{entity.name} has moved" if "at" in changes else f"better view of {entity.name}"
    confidence = _confidence(track, class_name or track.votes.belief(classes), classes)
    return Update(
        source="perception", agent=AGENT, reason=reason, name=entity.name, confidence=confidence, **changes
    )


def with_load(
    command: Update | Remove | None, entity: Entity, seen: Iterable[Entity]
) -> Update | Remove | None:
    """Return a move that also moves things on top that are not visible; visible things are observed.

    `seen` are the entities that are visible, or whose places are seen to be filled.
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
    """Return whether all facts of an entity are from perception."""
    return {entity.shape_provenance.source, entity.reference_provenance.source} == {"perception"}


def removal_of_leg(name: str, of: str) -> Remove:
    """Return the command to remove an entity that is a leg of furniture."""
    return Remove(source="perception", agent=AGENT, reason=f"{name} is a leg of {of}", names=(name,))


def _gone(entity: Entity, track: Track, own: bool, config: TrackingConfig) -> Update | Remove | None:
    if own and config.when_gone == "remove":
        frames = f"{track.odd or track.unseen} consecutive frames"
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
    """Return whether the pose of a thing differs from the map's."""
    if entity.pose is None:
        return True
    slack = slack_m(track.size_m, config.moved_m)
    return distance_m(entity.pose, track.pose) > slack or turn_between(track, entity.pose) > config.turned_rad


def _is_turned(entity: Entity, track: Track) -> bool:
    """Return whether the model of a thing has another yaw than perception sent to the map."""
    own = entity.pose_provenance is not None and entity.pose_provenance.source == "perception"
    return own and track.fit is not None and entity.pose is not None and track.fit.turned_from(entity.pose)


def _was_front(entity: Entity, track: Track) -> bool:
    """Return whether the map has only the front of a thing."""
    if entity.pose is None or entity.size_m is None:
        return False
    return is_front(OrientedBox(entity.pose, entity.size_m), OrientedBox(track.pose, track.size_m))


def _other_class(entity: Entity, track: Track, classes: ClassHierarchy, config: TrackingConfig) -> str:
    """Return the class of a thing, if it is more specific than the map's or contradicts it."""
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
    """Return a superclass of the map's class, if recent frames no longer support the map's class.

    Only a class that vision can distinguish from its subclasses is returned: the unknown class, or a learned
    one.
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
    """Return the changes that a better view gives: class, label and size."""
    changes: dict[str, Any] = {}
    if class_name:
        changes["class_"] = class_name
    reference = track.label or classes.label(class_name or entity.class_)
    follows = track.labels.clear_winner is not None  # else an earlier process may have stored a label
    if entity.preferred_reference != reference and (
        follows or entity.preferred_reference == classes.label(entity.class_)
    ):
        changes["ref"] = reference
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
    """Return the conflict of an observation with an operator's statement; kept until it is confirmed."""
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
