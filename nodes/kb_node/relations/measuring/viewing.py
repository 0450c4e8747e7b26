"""What depends on who looks: left and right, in front and behind, and what can be seen at all."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

from semmap.nodes.kb_node.relations.geometry.convex import contact, make_convex
from semmap.nodes.kb_node.relations.geometry.solids import Solid
from semmap.nodes.kb_node.relations.measuring import measures
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.schemas.entities import Vector
from semmap.schemas.relations import RelationName

_SLOPE = math.tan(math.radians(50.0))
"""A direction counts within 50 degrees of its axis."""
_EYES = 0.9
"""Of its height: where a viewer that is an entity has its eyes."""
_SIDE_OF_VIEW = math.cos(math.radians(60.0))
"""What is further than 60 degrees from where one looks is out of view."""
_RAYS = (-1 / 3, 0.0, 1 / 3)
"""Along each axis of a thing, the points that one looks at: shares of its extent, from its middle."""


class View(NamedTuple):
    """Where the eyes of a viewer are, map frame [m], and the unit direction in which it looks, level."""

    eyes: Vector
    ahead: tuple[float, float]

    @classmethod
    def of(cls, viewer: Solid) -> View:
        """That of an entity: its front is its +x."""
        x, y, z = viewer.to_map((0.0, 0.0, _EYES * viewer.size[2] if viewer.is_measured else 0.0))
        fx, fy = viewer.rotation[0][0], viewer.rotation[1][0]
        length = math.hypot(fx, fy) or 1.0
        return cls((x, y, z), (fx / length, fy / length))

    @classmethod
    def at(cls, x: float, y: float, z: float, yaw_rad: float) -> View:
        """From a pose."""
        return cls((x, y, z), (math.cos(yaw_rad), math.sin(yaw_rad)))


class Side(NamedTuple):
    """On which side of another a thing is, and by how much from centre to centre [m]."""

    relation: RelationName
    other: Solid
    by_m: float


def list_sides(space: Space, solid: Solid, view: View) -> Iterator[Side]:
    """Left of, right of, in front of and behind its neighbours, as a viewer sees them.

    The vantage is the viewer's, the front of a relatum is its side towards the viewer (Tenbrink and Kuhn
    2011); a direction counts within 50 degrees of its axis (Socher et al. 1997 grade it; here it is cut).
    """
    reach = 2.0 * space.limits.near_most_m
    for other in space.around(solid, reach):
        if other.is_place or measures.gap(solid, other) > reach:
            continue
        for relation, by_m in _as_faced(solid, other, view):
            yield Side(relation, other, by_m)


def is_on_side(space: Space, relation: RelationName, solid: Solid, other: Solid, view: View) -> bool:
    """Whether a thing is left of, right of, in front of or behind a neighbour, as a viewer sees the two."""
    if other.is_place or measures.gap(solid, other) > 2.0 * space.limits.near_most_m:
        return False
    return any(side == relation for side, _ in _as_faced(solid, other, view))


def _as_faced(solid: Solid, other: Solid, view: View) -> Iterator[tuple[RelationName, float]]:
    """The front of the other one is its side towards the viewer."""
    fx, fy = other.centre[0] - view.eyes[0], other.centre[1] - view.eyes[1]
    length = math.hypot(fx, fy)
    if length >= 1e-6:
        yield from _directions(solid, other, (-fx / length, -fy / length), mirrored=True)


def list_intrinsic_sides(solid: Solid, viewer: Solid) -> Iterator[Side]:
    """On which side of a thing that has a front, by that front."""
    for relation, by_m in _directions(solid, viewer, View.of(viewer).ahead, mirrored=False):
        yield Side(relation, viewer, by_m)


def _directions(
    solid: Solid, other: Solid, front: tuple[float, float], *, mirrored: bool
) -> Iterator[tuple[RelationName, float]]:
    """By the unit direction of a front. `mirrored`: left is that of who faces it, not its own."""
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
    """The share of the rays that reach a thing, and who is most in their way."""

    share: float
    blocker: str | None


def measure_visibility(space: Space, solid: Solid, view: View, viewer: Solid | None = None) -> Visibility:
    """How much of a thing can be seen: rays to points spread over it that nothing is in the way of.

    What collides is opaque. What is beside or behind the viewer is out of view.
    """
    x, y, z = solid.size
    free = 0
    blockers: dict[str, int] = {}
    others = [
        other for other in _near_the_sight(space, solid, view) if other is not solid and other is not viewer
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


def _near_the_sight(space: Space, solid: Solid, view: View) -> list[Solid]:
    """Whoever may be in the way."""
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
