"""Converts the positions of commands to the map frame, and those of replies from it. Pure functions."""

from __future__ import annotations

import math
from typing import TypeVar

from msgspec import structs

from semmap.nodes.coordinator.frames.tree import ORIGIN, pose_in_frame
from semmap.schemas import errors
from semmap.schemas.commands import Add, Drive, Get, List, Move, Update
from semmap.schemas.entities import REACH_M, Entity, Pose, Vector, compose, rounded
from semmap.schemas.relations import position_in
from semmap.schemas.scene_files import pose_of

Framed = Add | Update | Move | Drive | Get | List
"""The commands that have a `frame`."""
F = TypeVar("F", bound=Framed)
E = TypeVar("E", bound=Entity)


def require_position(command: Framed) -> None:
    """Raise BadRequest if a frame is given without a position, or for a time in the past."""
    if isinstance(command, Get | List):
        if command.as_of is not None:
            raise errors.BadRequest("past poses of frames are not stored; use either --frame or --as-of")
        if isinstance(command, List) and command.format != "json":
            raise errors.BadRequest(f"the format {command.format} uses the map frame; remove --frame")
    elif isinstance(command, Drive):
        if not command.to:
            raise errors.BadRequest(f"position in {command.frame} is missing: --frame requires --to X Y")
    elif isinstance(command, Add | Update):
        if command.extent is not None:
            raise errors.BadRequest("an extent is in the map frame; remove --frame")
        if command.at is None and command.yaw is None and command.orientation is None:
            raise errors.BadRequest(
                f"position in {command.frame} is missing: --frame requires --at X Y Z or --yaw"
            )


def convert_to_map(command: F, frame: Pose) -> F:
    """Return the command in the map frame, given the pose of its frame in the map.

    Without an angle only the position is converted: a new entity is upright and faces the map's +x, and a
    moved entity keeps its orientation. Raises BadRequest for an invalid pose and beyond `REACH_M`.
    """
    if isinstance(command, Get):
        return structs.replace(command, frame=None)
    if isinstance(command, List):
        near, to = (None if word is None else _word(word, frame) for word in (command.near, command.to))
        return structs.replace(command, near=near, to=to, frame=None)
    if isinstance(command, Drive):
        course = tuple(_position((x, y, 0.0), frame)[:2] for x, y in command.to)
        return structs.replace(command, to=course, yaw=_yaw(command.yaw, frame), frame=None)
    at = None if command.at is None else _position(command.at, frame)
    if isinstance(command, Move):
        return structs.replace(command, at=at, yaw=_yaw(command.yaw, frame), frame=None)
    if command.yaw is None and command.orientation is None:
        return structs.replace(command, at=at, frame=None)
    turned = compose(frame, pose_of(ORIGIN.position_m, command.yaw, command.orientation))
    orientation = rounded(turned).orientation_wxyz
    return structs.replace(command, at=at, yaw=None, orientation=orientation, frame=None)


def convert_to_frame(frame: Pose, entity: E) -> E:
    """Return the entity with its poses converted to a frame, given the pose of the frame in the map."""
    if entity.live is not None:
        live = structs.replace(entity.live, pose=pose_in_frame(frame, entity.live.pose))
        entity = structs.replace(entity, live=live)
    return entity if entity.pose is None else structs.replace(entity, pose=pose_in_frame(frame, entity.pose))


def _word(word: str, frame: Pose) -> str:
    at = position_in(word)
    return word if at is None else ",".join(map(repr, _position(at, frame)))


def _yaw(yaw: float | None, frame: Pose) -> float | None:
    return None if yaw is None else compose(frame, pose_of(ORIGIN.position_m, yaw, None)).yaw_rad


def _position(at: Vector, frame: Pose) -> Vector:
    x, y, z = (round(value, 6) + 0.0 for value in compose(frame, Pose(position_m=at)).position_m)
    if not all(math.isfinite(value) and abs(value) <= REACH_M for value in (x, y, z)):
        raise errors.BadRequest(
            f"the position is ({x:g}, {y:g}, {z:g}) in the map frame;"
            f" coordinates are limited to {REACH_M:,.0f} m"
        )
    return x, y, z
