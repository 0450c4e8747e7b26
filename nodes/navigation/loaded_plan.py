"""Converts a map server's plan to a scene of rooms and doors that can be loaded."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Final

import msgspec

from semmap.nodes.geometry.polygons import Point
from semmap.nodes.navigation.map_server import MapDescription, Pixels, grid_of, has_unknown_grey
from semmap.nodes.navigation.rooms import RoomSegmentation, segment_rooms
from semmap.schemas import errors, scene_files
from semmap.schemas.polygons import simple, wkt
from semmap.schemas.scene_files import SceneFile

_DOOR_M: Final = (0.06, 2.08)
"""Thickness and height of a door."""
_DIGITS: Final = 3


@dataclass(frozen=True)
class LoadedPlan:
    """The result for a plan: a scene of rooms and doors, and a line of text on each."""

    scene: SceneFile
    lines: tuple[str, ...]

    @property
    def content(self) -> bytes:
        """Return the scene as a file."""
        return msgspec.json.encode(self.scene)


def loaded_plan(described: MapDescription, pixels: Pixels, name: str) -> LoadedPlan:
    """Return the rooms of a plan as places, and the passages between them as doors.

    Raises BadFile for a plan without free space, or with rooms that are all too small.
    """
    found = segment_rooms(grid_of(described, pixels))
    if not found.rooms:
        raise errors.BadFile(
            f"{name} has no free area of more than 2 square metres; check its thresholds, resolution"
            " and negate"
        )
    plan = _scene(found, described)
    if not has_unknown_grey(described, pixels):
        return plan
    note = (
        "note: pixels of value 205 are unknown, although free_thresh"
        f" {described.free_thresh:g} makes them free; ROS's map_saver writes unknown cells so"
    )
    return replace(plan, lines=(*plan.lines, note))


def _scene(found: RoomSegmentation, described: MapDescription) -> LoadedPlan:
    x0, y0, yaw = described.origin
    c, s = math.cos(yaw), math.sin(yaw)

    def placed(point: Point) -> Point:
        x, y = point
        return round(x0 + c * x - s * y, _DIGITS), round(y0 + s * x + c * y, _DIGITS)

    rooms = [f"room{k}" for k in range(1, len(found.rooms) + 1)]
    entities: list[scene_files.Described] = []
    lines: list[str] = []
    for name, room in zip(rooms, found.rooms, strict=True):
        polygon = simple([[placed(point) for point in ring] for ring in room.polygon.rings])
        entities.append(scene_files.Described(class_="Room", name=name, extent=wkt(polygon)))
        left, low, right, high = polygon.bounds
        lines.append(
            f"{name}: {room.area_m2:.1f} square metres, x {left:g} to {right:g}, y {low:g} to {high:g}"
        )
    for k, door in enumerate(found.doorways, start=1):
        x, y = placed(door.middle)
        between = [rooms[room] for room in door.rooms]
        entities.append(
            scene_files.Described(
                class_="Door",
                name=f"doorway{k}",
                at=(x, y, 0.0),
                yaw=round((door.yaw_rad + yaw + math.pi / 2) % math.pi - math.pi / 2, 4) + 0.0,
                size=(_DOOR_M[0], max(door.width_m, 0.1), _DOOR_M[1]),
                set=tuple(f"connects={room}" for room in between),
            )
        )
        lines.append(
            f"doorway{k}: {door.width_m:g} m wide at ({x:g}, {y:g}), from {between[0]} to {between[1]}"
        )
    return LoadedPlan(SceneFile(entities=tuple(entities)), tuple(lines))
