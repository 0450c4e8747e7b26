"""View-dependent relations: left and right, in front and behind, and visibility."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

from semmap.nodes.kb_node.relations.geometry.convex import contact, make_convex
from semmap.nodes.kb_node.relations.geometry.solids import Solid
from semmap.nodes.kb_node.relations.measuring import proximity
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.schemas.entities import Vector
from semmap.schemas.relations import RelationName

_SLOPE = math.tan(math.radians(50.0))
"""A direction counts within 50 degrees of its axis."""
_EYES = 0.9
"""The height of the eyes of a viewing entity, relative to its own height."""
_SIDE_OF_VIEW = math.cos(math.radians(60.0))
"""Objects more than 60 degrees from the viewing direction are out of view."""
_RAYS = (-1 / 3, 0.0, 1 / 3)
"""Target points of rays along each axis of an object, as shares of its extent from its centre."""


class View(NamedTuple):
    """A viewpoint: the eyes in the map frame [m] and the horizontal unit viewing direction."""

    eyes: Vector
    ahead: tuple[float, float]

    @classmethod
    def of(cls, viewer: Solid) -> View:
        """Return the view of an entity, whose front is its +x axis."""
        x, y, z = viewer.to_map((0.0, 0.0, _EYES * viewer.size[2] if viewer.is_measured else 0.0))
        fx, fy = viewer.rotation[0][0], viewer.rotation[1][0]
        length = math.hypot(fx, fy) or 1.0
        return cls((x, y, z), (fx / length, fy / length))

    @classmethod
    def at(cls, x: float, y: float, z: float, yaw_rad: float) -> View:
        """Return the view from a pose."""
        return cls((x, y, z), (math.cos(yaw_rad), math.sin(yaw_rad)))


class Side(NamedTuple):
    """The side of another object on which an object is, with the offset between centres [m]."""

    relation: RelationName
    other: Solid
    by_m: float


def list_sides(space: Space, solid: Solid, view: View) -> Iterator[Side]:
    """Yield left of, right of, in front of and behind for the neighbours, as seen from a view.

    The vantage is the viewer's, and the front of a relatum is its side towards the viewer (Tenbrink and
    Kuhn 2011). A direction counts within 50 degrees of its axis (Socher et al. 1997 grade it, here it is
    cut off).
    """
    reach = 2.0 * space.limits.near_most_m
    for other in space.around(solid, reach):
        if other.is_place or proximity.gap(solid, other) > reach:
            continue
        for relation, by_m in _list_facing_sides(solid, other, view):
            yield Side(relation, other, by_m)


def is_on_side(space: Space, relation: RelationName, solid: Solid, other: Solid, view: View) -> bool:
    """Return whether a solid is on the given side of a neighbour, as seen from a view."""
    if other.is_place or proximity.gap(solid, other) > 2.0 * space.limits.near_most_m:
        return False
    return any(side == relation for side, _ in _list_facing_sides(solid, other, view))


def _list_facing_sides(solid: Solid, other: Solid, view: View) -> Iterator[tuple[RelationName, float]]:
    """Yield the sides, where the front of the other solid faces the viewer."""
    fx, fy = other.centre[0] - view.eyes[0], other.centre[1] - view.eyes[1]
    length = math.hypot(fx, fy)
    if length >= 1e-6:
        yield from _directions(solid, other, (-fx / length, -fy / length), mirrored=True)


def list_intrinsic_sides(solid: Solid, viewer: Solid) -> Iterator[Side]:
    """Yield the sides of an object that has a front, relative to that front."""
    for relation, by_m in _directions(solid, viewer, View.of(viewer).ahead, mirrored=False):
        yield Side(relation, viewer, by_m)


def _directions(
    solid: Solid, other: Solid, front: tuple[float, float], *, mirrored: bool
) -> Iterator[tuple[RelationName, float]]:
    """Yield the sides relative to the unit direction of a front.

    If `mirrored`, left is that of an observer who faces the object.
    """
    dx, dy = solid.centre[0] - other.centre[0], solid.centre[1] - other.centre[1]
    ahead, left = dx * front[0] + dy * front[1], dy * front[0] - dx * front[1]
    if mirrored:
        left = -left
    if max(abs(ahead), abs(left)) < 0.5 * min(*solid.size[:2], *other.size[:2]):
        return
    if abs(left) >= abs(ahead) / _SLOPE:
        yield "isLeftOf" if left > 0 else "isRightOf", abs(left)
    if abs(ahead) >= abs(left) / _SLOPE:
        yield "isInFrontOf" if ahead > 0 else "isBehind", abs(ahead)


class Visibility(NamedTuple):
    """The share of the rays that reach an object, and the object that blocks most of the others."""

    share: float
    blocker: str | None


def measure_visibility(space: Space, solid: Solid, view: View, viewer: Solid | None = None) -> Visibility:
    """Return how much of an object is visible, by rays to points spread over it.

    Colliding shapes are opaque. Points beside or behind the viewer are out of view.
    """
    x, y, z = solid.size
    free = 0
    blockers: dict[str, int] = {}
    others = [
        other for other in _find_blockers(space, solid, view) if other is not solid and other is not viewer
    ]
    points = [solid.to_map((u * x, v * y, (w + 0.5) * z)) for u in _RAYS for v in _RAYS for w in _RAYS]
    for point in points:
        if not _in_view(view, point):
            continue
        blocker = next((other.name for other in others if _blocks(other, view.eyes, point)), None)
        if blocker is None:
            free += 1
        else:
            blockers[blocker] = blockers.get(blocker, 0) + 1
    return Visibility(
        free / len(points), max(blockers, key=lambda name: (blockers[name], name), default=None)
    )


def _in_view(view: View, point: Vector) -> bool:
    dx, dy, dz = (p - e for p, e in zip(point, view.eyes, strict=True))
    length = math.sqrt(dx * dx + dy * dy + dz * dz)
    return length > 0.0 and dx * view.ahead[0] + dy * view.ahead[1] >= _SIDE_OF_VIEW * length


def _find_blockers(space: Space, solid: Solid, view: View) -> list[Solid]:
    """Return the solids that may block the view."""
    x, y, _ = view.eyes
    x0, y0, x1, y1 = solid.bounds
    return [o for o in space.find_within((min(x, x0), min(y, y0), max(x, x1), max(y, y1))) if not o.is_place]


def _blocks(other: Solid, eyes: Vector, point: Vector) -> bool:
    middle = tuple((a + b) / 2 for a, b in zip(eyes, point, strict=True))
    half = tuple((b - a) / 2 for a, b in zip(eyes, point, strict=True))
    ray = make_convex(middle, (half,), ())  # type: ignore[arg-type]
    return any(
        all(ray.low[k] <= part.high[k] and part.low[k] <= ray.high[k] for k in range(3))
        and contact(ray, part, 0.0).distance < 0.0
        for part in other.parts
    )
