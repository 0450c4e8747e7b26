"""Relations that depend on more than two objects: next to, between, attached to."""

from __future__ import annotations

import math
from collections.abc import Iterator, Set

from semmap.nodes.geometry.polygons import area, clipped, hull
from semmap.nodes.kb_node.relations.geometry.solids import Solid
from semmap.nodes.kb_node.relations.measuring import measures, proximity
from semmap.nodes.kb_node.relations.measuring.measures import Measure
from semmap.nodes.kb_node.relations.measuring.space import Space

_OPPOSITE = -math.cos(math.radians(60.0))
"""An object between two others sees them in directions at least 120 degrees apart."""


def measure_next_to(space: Space, one: Solid, other: Solid) -> Measure | None:
    """Return whether two objects are near, on the same support or floor, with nothing between them.

    None if they are not near. Otherwise `holds` is False with `share` 0 on different supports, and with
    `share` 0.5 if an object is between them.
    """
    made = proximity.near(one, other, space.limits)
    if made is None or not made.holds:
        return None
    if not _share_support(space, one, other):
        return made._replace(holds=False, share=0.0)
    is_free = next(_iterate_between(space, one, other), None) is None
    return made if is_free else made._replace(holds=False, share=0.5)


def _share_support(space: Space, one: Solid, other: Solid) -> bool:
    (around, below), (around_other, below_other) = (_find_bearers(space, solid) for solid in (one, other))
    if around is not None or around_other is not None:
        return around is around_other
    if below or below_other:
        return not below.isdisjoint(below_other)
    return abs(one.bottom - other.bottom) <= space.limits.gap_m


def _find_bearers(space: Space, solid: Solid) -> tuple[Solid | None, Set[Solid]]:
    """Return what encloses a solid, and its supports, such as the top that a fixture is let into."""
    container, supports, _ = space.spatial_relations(solid)
    below = {support for support, _ in supports}
    if container is None:
        return None, below
    outer, made = container
    return (None, {*below, outer}) if made.by_edge else (outer, below)


def find_between(space: Space, one: Solid, other: Solid) -> list[Solid]:
    """Return the objects on the strip that joins two others, at their height, ordered by name."""
    return sorted(_iterate_between(space, one, other), key=lambda solid: solid.name)


def _iterate_between(space: Space, one: Solid, other: Solid) -> Iterator[Solid]:
    strip = hull([*one.outline, *other.outline])
    low, high = max(one.bottom, other.bottom), min(one.top, other.top)
    apart = proximity.gap(one, other)
    for third in space.counted_around(one, apart):
        if third is other or third.is_place or not third.is_measured:
            continue
        if not measures.overlap(third.bounds, other.bounds, apart):
            continue  # further from `other` than the two are apart
        if third.bottom >= high or third.top <= low + space.limits.contact_m:
            continue
        footprint = max(third.footprint, 1e-9)
        if area(clipped(third.outline, strip)) < 0.5 * footprint:
            continue
        ax, ay = one.centre[0] - third.centre[0], one.centre[1] - third.centre[1]
        bx, by = other.centre[0] - third.centre[0], other.centre[1] - third.centre[1]
        lengths = math.hypot(ax, ay) * math.hypot(bx, by)
        if lengths > 0.0 and ax * bx + ay * by <= _OPPOSITE * lengths:
            yield third


def measure_attachment(space: Space, solid: Solid, other: Solid) -> Measure | None:
    """Return whether an object without support is against a side of another one, off the floor.

    None if it is not beside the other one, or is supported.
    """
    made = proximity.against(solid, other, space.limits)
    if made is None or is_supported(space, solid) or not space.may_hold(other, solid):
        return None
    return made


def find_attachments(space: Space, solid: Solid) -> Iterator[Solid]:
    """Yield the objects that an object is attached to."""
    margin = space.limits.attached_m
    if not solid.is_measured or solid.name in space.holders:
        return
    highest = solid.bottom - space.limits.gap_m
    found = [
        other
        for other in space.supporters_around(solid, margin)
        if other.top > solid.bottom
        and other.bottom < highest
        and not other.is_place
        and (made := proximity.against(solid, other, space.limits))
        and made.holds
        and space.may_hold(other, solid)
    ]
    if found and not is_supported(space, solid):
        yield from sorted(found, key=lambda other: other.name)


def is_supported(space: Space, solid: Solid) -> bool:
    """Return whether anything holds an object: a support, the floor of its place, or a holder."""
    if solid.name in space.holders:
        return True
    return bool(space.spatial_relations(solid).supporters) or stands_on_floor(space, solid)


def stands_on_floor(space: Space, solid: Solid) -> bool:
    """Return whether an object is in and on nothing but the floor of its place."""
    found = space.spatial_relations(solid)
    if found.supporters or found.place is None:
        return False
    return abs(solid.bottom - found.place[0].bottom) <= space.limits.gap_m


def stands_on_ground(space: Space, solid: Solid) -> bool:
    """Return whether the bottom of an object is at the floor of its place, or at height 0 without one."""
    place = space.spatial_relations(solid).place
    return abs(solid.bottom - (place[0].bottom if place is not None else 0.0)) <= space.limits.gap_m
