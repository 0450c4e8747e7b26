"""Leaning: an object that would not stand without another one that holds it sideways."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

from semmap.nodes.geometry.polygons import Point, area, clipped, contains, distance, hull
from semmap.nodes.kb_node.relations.geometry.convex import (
    DOWN,
    UP,
    Convex,
    contact,
    find_face,
    over_flat_top,
)
from semmap.nodes.kb_node.relations.geometry.solids import Solid
from semmap.nodes.kb_node.relations.measuring import measures, proximity
from semmap.nodes.kb_node.relations.measuring.arrangement import stands_on_ground
from semmap.nodes.kb_node.relations.measuring.measures import Measure
from semmap.nodes.kb_node.relations.measuring.phrases import format_length
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.schemas.entities import Vector

_STEEPEST = math.sin(math.radians(45.0))
"""The greatest vertical component of a contact normal that is mainly horizontal."""
_BALANCED_M = 0.002
"""An object whose centre is this close to its base seen from above stands, as a ball does."""


class _Lean(NamedTuple):
    """A contact that holds an object at its side."""

    gap_m: float
    height_m: float
    """Height of the contact in the map."""
    tilt_rad: float
    """Between the vertical and the line from the base to the contact."""
    normal: Vector


def measure_leaning(space: Space, solid: Solid, other: Solid) -> Measure | None:
    """Return the contact with which one object leans against another, or None.

    All of these hold:

    - Something else supports it from below: another object or the floor.
    - Its base alone does not hold it: its centre is not above the base.
    - The other one touches it along a normal that is mainly horizontal, not below its centre.
    - The line from its base to this contact is tilted towards the other one.
    - Nothing else that it leans against is nearer in the same direction.
    """
    lean = _find_lean(space, solid, other)
    if lean is None or _find_nearer(space, solid, other, lean) is not None:
        return None
    return Measure(True, lean.gap_m, height_m=lean.height_m, limit=space.limits.lean_gap_m)


def explain_leaning(space: Space, solid: Solid, other: Solid, made: Measure | None) -> str:
    """Return why an object leans or does not lean against another one, with the measured values."""
    limits, name, centre = space.limits, other.name, format_length(solid.centre[2])
    base = _find_base(space, solid, other)
    if not base:
        return f"nothing but {name} may support it, and a leaning object also stands on something"
    if (lean := _find_lean(space, solid, other)) is not None:
        if (nearer := _find_nearer(space, solid, other, lean)) is not None:
            return f"{nearer.name} is between them, and it leans against that"
        tilt, height = f"{math.degrees(lean.tilt_rad):.1f}°", format_length(lean.height_m)
        beside = format_length(distance([solid.centre[:2]], base))
        return (
            f"it leans over by {tilt} from its base to {name}, which it meets at a height of {height};"
            f" its centre, at {centre}, is {beside} beside its base, so it would not stand alone"
        )
    if _is_balanced(solid, base):
        return "it needs no support at its side: its centre is above its base"
    contacts = list(_list_contacts(space, solid, other))
    sideways = [height for _, normal, height, _ in contacts if abs(normal[2]) <= _STEEPEST]
    if not contacts:
        apart, limit = proximity.gap(solid, other), format_length(limits.lean_gap_m)
        if apart > limits.lean_gap_m:
            return f"they are {format_length(apart)} apart (isLeaningAgainst allows up to {limit})"
        return f"no part of one is beside a part of the other within {limit}"
    if not sideways:
        return f"it touches {name} from above or below, and not at its side"
    if max(sideways) < solid.centre[2]:
        height = format_length(max(sideways))
        return f"it meets {name} up to a height of {height}, which is below its centre at {centre}"
    return f"it is tilted towards {name} by less than {limits.lean_deg:g}°"


def _find_lean(space: Space, solid: Solid, other: Solid) -> _Lean | None:
    """Return the highest contact with which one solid leans against another."""
    if solid is other or not (solid.has_parts and other.has_parts) or other.top < solid.centre[2]:
        return None
    found: _Lean | None = None
    base: list[Point] = []
    for gap, (nx, ny, nz), height, level in _list_contacts(space, solid, other):
        if abs(nz) > _STEEPEST or height < solid.centre[2] or (found and height <= found.height_m):
            continue
        base = base or _find_base(space, solid, other)
        if not base or _is_balanced(solid, base):
            return None
        # The surface of the contact, in the direction towards the other solid, at the height of the contact.
        across = math.hypot(nx, ny)
        reach = (nz * height - level) / across
        ahead = reach - max(-(nx * x + ny * y) / across for x, y in base)
        tilt = math.atan2(ahead, height - solid.bottom)
        if tilt >= math.radians(space.limits.lean_deg):
            found = _Lean(gap, height, tilt, (nx, ny, nz))
    return found


def _find_nearer(space: Space, solid: Solid, other: Solid, lean: _Lean) -> Solid | None:
    """Return an object nearer than `other` against which a solid leans in the same direction."""
    for third in space.counted_around(solid, space.limits.lean_gap_m):
        if third is not other and (its := _find_lean(space, solid, third)) is not None:
            same = sum(a * b for a, b in zip(lean.normal, its.normal, strict=True)) > _STEEPEST
            if same and its.gap_m < lean.gap_m - space.limits.contact_m:
                return third
    return None


def _list_contacts(space: Space, solid: Solid, other: Solid) -> Iterator[tuple[float, Vector, float, float]]:
    """Yield the contacts of the parts of two solids beside each other.

    Each has a distance [m], a normal towards `solid`, the height of its highest point [m], and the position
    of the surface of `solid` along the normal [m].
    """
    limits = space.limits
    limit = limits.lean_gap_m
    if not measures.overlap(solid.bounds, other.bounds, limit):
        return
    slack = math.sin(math.radians(limits.lean_deg))
    for part in solid.parts:
        (x0, y0, z0), (x1, y1, z1) = part.low, part.high
        for its in other.parts:
            (a0, b0, c0), (a1, b1, c1) = its.low, its.high
            if max(x0 - a1, a0 - x1, y0 - b1, b0 - y1, z0 - c1, c0 - z1) > limit:
                continue
            if over_flat_top(part, its) or over_flat_top(its, part):
                continue
            gap, normal = contact(part, its, limit)
            if not -limits.gap_m <= gap <= limit:
                continue
            nx, ny, nz = normal
            face, its_face = find_face(part, (-nx, -ny, -nz), slack), find_face(its, normal, slack)
            height = min(max(z for _, _, z in face), max(z for _, _, z in its_face))
            yield gap, normal, height, min(nx * x + ny * y + nz * z for x, y, z in face)


def _is_balanced(solid: Solid, base: list[Point]) -> bool:
    """Return whether the centre of a solid is above its base."""
    centre = solid.centre[:2]
    return (len(base) > 2 and contains(base, centre)) or distance([centre], base) <= _BALANCED_M


def _find_base(space: Space, solid: Solid, other: Solid) -> list[Point]:
    """Return the hull of the areas that support a solid from below, except `other`; empty without any."""
    if solid.name in space.holders or not solid.parts:
        return []
    below = [support for support in space.spatial_relations(solid).supporters if support is not other]
    points = [point for support in below for point in _list_meeting_points(space, solid, support)]
    if stands_on_ground(space, solid) or (below and not points):
        points += [(x, y) for x, y, _ in _find_feet(space, solid)]
    return hull(points)


def _find_feet(space: Space, solid: Solid) -> list[Vector]:
    """Return the corners on which a solid stands on level ground."""
    slack = math.sin(math.radians(space.limits.lean_deg))
    corners = [corner for part in solid.parts for corner in find_face(part, DOWN, slack)]
    lowest = min(corners, key=lambda corner: corner[2])
    return [
        corner
        for corner in corners
        if corner[2] - lowest[2] <= slack * math.dist(corner, lowest) + space.limits.contact_m
    ]


def _list_meeting_points(space: Space, solid: Solid, support: Solid) -> Iterator[Point]:
    """Yield corners of the areas in which a support touches a solid from below, as seen from above."""
    limits = space.limits
    slack = math.sin(math.radians(limits.lean_deg))
    for part in solid.parts:
        for its in support.parts:
            if part.low[2] - its.high[2] > limits.gap_m or not _overlap(part, its):
                continue
            normal = UP
            if not over_flat_top(part, its):
                gap, normal = contact(part, its, limits.gap_m)
                if not -limits.gap_m <= gap <= limits.gap_m or normal[2] < limits.upright:
                    continue
            nx, ny, nz = normal
            face = hull([(x, y) for x, y, _ in find_face(part, (-nx, -ny, -nz), slack)])
            top = hull([(x, y) for x, y, _ in find_face(its, normal, slack)])
            if area(top) < area(face):
                yield from clipped(top, part.projection)
            else:
                yield from clipped(face, its.projection)


def _overlap(part: Convex, its: Convex) -> bool:
    """Return whether the bounds of two parts overlap, as seen from above."""
    return all(part.low[k] <= its.high[k] and its.low[k] <= part.high[k] for k in (0, 1))
