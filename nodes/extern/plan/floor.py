"""The contents of a plan in the map frame [m]: rooms, parts of rooms, and the footprints of objects."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final, Literal

from semmap.nodes.geometry.polygons import Point, Polygon, area, clipped, hull
from semmap.ontology.model_shapes import own_size_m
from semmap.schemas.entities import Entity, Pose, Quaternion, Size
from semmap.schemas.plans import Plan, PlannedThing
from semmap.schemas.polygons import Polygon as Outline
from semmap.schemas.polygons import extent_of

Kind = Literal["furniture", "small", "person", "door", "window", "overhead"]
"""`small`: an object on another one. `overhead`: an object above the height of people."""

OVERHEAD_M: Final = 2.0
"""Objects whose bottom is higher above the floor are drawn dashed."""
_ON_SOMETHING_M: Final = 0.25
_SMALL_M2: Final = 0.12
_COVERED_M: Final = 0.001
_MOSTLY: Final = 0.6
"""The fraction of its floor from which a place counts as part of another one, or as composed of others."""


@dataclass(frozen=True)
class Area:
    """A room or a part of one; `outline` counterclockwise."""

    name: str
    label: str
    outline: tuple[Point, ...]

    @property
    def floor_m2(self) -> float:
        """The area of its floor [m^2]."""
        return area(self.outline)


@dataclass(frozen=True)
class Piece:
    """An object; `outline` is the convex hull of its footprint, counterclockwise.

    `parts` are the convex outlines of its parts, without those that others cover; empty if it is drawn whole.
    """

    name: str
    kind: Kind
    outline: tuple[Point, ...]
    top_m: float
    is_open: bool = False
    parts: tuple[tuple[Point, ...], ...] = ()


@dataclass(frozen=True)
class Floor:
    """The contents of a plan. `pieces` are ordered by their tops: upper objects are drawn last."""

    rooms: tuple[Area, ...]
    zones: tuple[Area, ...]
    pieces: tuple[Piece, ...]
    unplaced: int = 0
    """The number of entities without a position or a size, which are not drawn."""

    def at(self, point: Point) -> str | None:
        """Return the name of the uppermost object at a point of the map [m], or of the room."""
        shapes: list[Area | Piece] = [*reversed(self.pieces), *reversed(self.zones), *self.rooms]
        return next((shape.name for shape in shapes if _is_at(shape, point)), None)

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """The least and greatest x, then y, without doors and windows; a square metre for an empty plan."""
        inside = [piece for piece in self.pieces if piece.kind not in ("door", "window")]
        shapes: list[Area | Piece] = [*self.rooms, *self.zones, *inside]
        points = [point for shape in shapes for point in shape.outline]
        if not points:
            return (0.0, 1.0, 0.0, 1.0)
        xs, ys = zip(*points, strict=True)
        return (min(xs), max(xs), min(ys), max(ys))


def floor_of(
    entities: Iterable[Entity],
    poses: Mapping[str, Pose] | None = None,
    outlines: Mapping[str, Polygon] | None = None,
    body_sizes_m: Mapping[str, Size] | None = None,
    plan: Plan | None = None,
) -> Floor:
    """Return the plan of these entities, at `poses` or else at their poses in the map.

    The outline of a place is its extent, or the one in `outlines` (map frame [m], counterclockwise). An
    object has the outlines of its parts in `plan`, which is computed from the shapes that the knowledge base
    has. Without these, it is a box of its asserted size, that of its body in `body_sizes_m`, or its model's.
    """
    poses, outlines, body_sizes_m = poses or {}, outlines or {}, body_sizes_m or {}
    things = {} if plan is None else {thing.name: thing for thing in plan.things}
    places: list[Area] = []
    pieces: list[Piece] = []
    unplaced = 0
    for entity in sorted(entities, key=lambda e: e.name):
        parts: tuple[tuple[Point, ...], ...] = ()
        pose = poses.get(entity.name, entity.pose)
        size_m = entity.size_m
        if size_m is None and entity.model and not entity.place:
            size_m = body_sizes_m.get(entity.name) or own_size_m(entity.model)
        if entity.place and entity.name in outlines:
            outline = tuple(outlines[entity.name])
        elif (extent := extent_of(entity)) is not None:
            outline = extent.outer
        elif pose is not None and size_m is not None:
            is_opening = not {"Door", "Window"}.isdisjoint(entity.types)  # drawn as a gap in a wall
            if not is_opening:
                parts = _parts(things.get(entity.name), entity.pose, pose)
            outline = tuple(hull([point for part in parts for point in part])) or footprint(pose, size_m)
        else:
            unplaced += 1
            continue
        if entity.place:
            places.append(Area(entity.name, entity.preferred_reference or entity.name, outline))
        elif pose is not None and size_m is not None:
            top_m = pose.position_m[2] + size_m[2]
            is_open = entity.properties.get("isOpen") is True
            pieces.append(Piece(entity.name, _kind(entity, pose, outline), outline, top_m, is_open, parts))
    rooms, zones = _rooms_and_zones(places)
    return Floor(rooms, zones, tuple(sorted(pieces, key=lambda p: (p.top_m, p.name))), unplaced)


def _is_at(shape: Area | Piece, point: Point) -> bool:
    outlines = (isinstance(shape, Piece) and shape.parts) or (shape.outline,)
    return any(Outline(outline).contains(point) for outline in outlines)


def _parts(thing: PlannedThing | None, was: Pose | None, now: Pose) -> tuple[tuple[Point, ...], ...]:
    """Return the outlines of the parts of an object, which has moved from the pose of its plan.

    The largest is first, and those that another one covers are omitted. The result is empty if they are
    unknown, and for a tilted object that has moved.
    """
    if thing is None or was is None:
        return ()
    corners = sorted((part.corners for part in thing.parts), key=lambda outline: -area(outline))
    if was != now:
        if not (_is_upright(was.orientation_wxyz) and _is_upright(now.orientation_wxyz)):
            return ()
        corners = [_moved(outline, was, now) for outline in corners]
    kept: list[tuple[Point, ...]] = []
    for outline in corners:
        if not any(_covers(other, outline) for other in kept):
            kept.append(tuple(outline))
    return tuple(kept)


def _moved(outline: Polygon, was: Pose, now: Pose) -> tuple[Point, ...]:
    """Return an outline of an upright object after it moved."""
    turn = now.yaw_rad - was.yaw_rad
    cos, sin = math.cos(turn), math.sin(turn)
    (x0, y0, _), (x1, y1, _) = was.position_m, now.position_m
    return tuple(
        (x1 + cos * (x - x0) - sin * (y - y0), y1 + sin * (x - x0) + cos * (y - y0)) for x, y in outline
    )


def _covers(outer: Polygon, inner: Polygon) -> bool:
    """Return whether all points of an outline are in a convex one, to a millimetre."""
    ax, ay = outer[-1]
    for bx, by in outer:
        ex, ey = bx - ax, by - ay
        least = -_COVERED_M * math.hypot(ex, ey)
        if any(ex * (py - ay) - ey * (px - ax) < least for px, py in inner):
            return False
        ax, ay = bx, by
    return True


def footprint(pose: Pose, size: Size) -> tuple[Point, ...]:
    """Return the footprint of a box in any orientation, counterclockwise, in the map frame [m]."""
    half_x, half_y, height = size[0] / 2.0, size[1] / 2.0, size[2]
    heights = (0.0,) if _is_upright(pose.orientation_wxyz) else (0.0, height)
    x0, y0, _ = pose.position_m
    (xx, xy, xz), (yx, yy, yz) = _floor_axes(pose.orientation_wxyz)
    corners = [(x, y, z) for x in (-half_x, half_x) for y in (-half_y, half_y) for z in heights]
    return tuple(
        hull([(x0 + xx * x + xy * y + xz * z, y0 + yx * x + yy * y + yz * z) for x, y, z in corners])
    )


def _is_upright(wxyz: Quaternion) -> bool:
    return math.hypot(wxyz[1], wxyz[2]) < 1e-3


def _floor_axes(wxyz: Quaternion) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    """Return the first two rows of the rotation matrix."""
    w, x, y, z = wxyz
    return (
        (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
    )


def _kind(entity: Entity, pose: Pose, outline: Polygon) -> Kind:
    if "Door" in entity.types:
        return "door"
    if "Window" in entity.types:
        return "window"
    if "Person" in entity.types:
        return "person"
    bottom_m = pose.position_m[2]
    if bottom_m > OVERHEAD_M:
        return "overhead"
    return "small" if bottom_m > _ON_SOMETHING_M or area(outline) < _SMALL_M2 else "furniture"


def _rooms_and_zones(places: Sequence[Area]) -> tuple[tuple[Area, ...], tuple[Area, ...]]:
    """Return rooms and parts of rooms. A place that is composed of others, such as a flat, is neither."""
    ordered = sorted((p for p in places if p.floor_m2 > 0.0), key=lambda p: -p.floor_m2)
    rooms: list[Area] = []
    zones: list[Area] = []
    for i, place in enumerate(ordered):
        if any(_shared_m2(place, room) > _MOSTLY * place.floor_m2 for room in rooms):
            zones.append(place)
        elif _is_made_up(place, ordered[i + 1 :]):
            continue
        else:
            rooms.append(place)
    return tuple(rooms), tuple(zones)


def _is_made_up(place: Area, smaller: Sequence[Area]) -> bool:
    """Return whether several smaller places without much overlap cover most of its floor."""
    parts: list[Area] = []
    for other in smaller:
        apart = all(_shared_m2(other, part) < 0.1 * other.floor_m2 for part in parts)
        if apart and _shared_m2(other, place) > _MOSTLY * other.floor_m2:
            parts.append(other)
    return len(parts) > 1 and sum(part.floor_m2 for part in parts) > _MOSTLY * place.floor_m2


def _shared_m2(a: Area, b: Area) -> float:
    """Return the area that two places share, by their convex hulls [m^2]."""
    return area(clipped(hull(a.outline), hull(b.outline)))
