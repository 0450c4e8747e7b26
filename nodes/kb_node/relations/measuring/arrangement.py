"""Relations that depend on more than two: next to, between, attached to."""

from __future__ import annotations

import math
from collections.abc import Iterator

from semmap.nodes.geometry.polygons import area, clipped, distance, hull
from semmap.nodes.kb_node.relations.geometry.solids import Solid
from semmap.nodes.kb_node.relations.measuring import measures
from semmap.nodes.kb_node.relations.measuring.measures import Measure
from semmap.nodes.kb_node.relations.measuring.space import Space

_OPPOSITE = -math.cos(math.radians(60.0))
"""What is between two sees them in directions this far from one another: 120 degrees or more."""
BESIDE_M = 0.2
"""What is further from another thing is not beside it."""
ALONGSIDE = 0.5
"""Of the height of what hangs that is alongside what it hangs on."""


def measure_next_to(space: Space, one: Solid, other: Solid) -> Measure | None:
    """Near, on the same support or floor, and nothing between the two; None for what is not near.

    `holds` is False, and `share` 0, where the two stand on different things; `share` is 0.5 where something
    is between them.
    """
    made = measures.near(one, other, space.limits)
    if made is None or not made.holds:
        return None
    if not _stand_alike(space, one, other):
        return made._replace(holds=False, share=0.0)
    is_free = next(_in_between(space, one, other), None) is None
    return made if is_free else made._replace(holds=False, share=0.5)


def _stand_alike(space: Space, one: Solid, other: Solid) -> bool:
    ours, theirs = space.spatial_relations(one), space.spatial_relations(other)
    if ours.container is not None or theirs.container is not None:
        return (
            ours.container is not None
            and theirs.container is not None
            and (ours.container[0] is theirs.container[0])
        )
    if ours.supports or theirs.supports:
        return not {s for s, _ in ours.supports}.isdisjoint(s for s, _ in theirs.supports)
    return abs(one.bottom - other.bottom) <= space.limits.gap_m


def find_between(space: Space, one: Solid, other: Solid) -> list[Solid]:
    """What is between two things, by name: over or on the strip that joins them, at their height."""
    return sorted(_in_between(space, one, other), key=lambda solid: solid.name)


def _in_between(space: Space, one: Solid, other: Solid) -> Iterator[Solid]:
    strip = hull([*one.outline, *other.outline])
    low, high = max(one.bottom, other.bottom), min(one.top, other.top)
    apart = measures.gap(one, other)
    for third in space.counted_around(one, apart):
        if third is other or third.is_place or not third.is_measured:
            continue
        if not measures.overlap(third.bounds, other.bounds, apart):
            continue  # it is further from the other than the two are from one another
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
    """Whether one hangs on the side of the other: nothing bears it, and it is against that, off the floor.

    None for what is not beside the other, or is borne.
    """
    made = _against(space, solid, other)
    return None if made is None or is_supported(space, solid) else made


def find_attachments(space: Space, solid: Solid) -> Iterator[Solid]:
    """What a thing hangs on."""
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
        and (made := _against(space, solid, other))
        and made.holds
    ]
    if found and not is_supported(space, solid):
        yield from sorted(found, key=lambda other: other.name)


def _against(space: Space, solid: Solid, other: Solid) -> Measure | None:
    limits = space.limits
    if solid is other or solid.is_place or other.is_place or not solid.is_measured:
        return None
    if solid.bottom <= other.bottom + limits.gap_m or solid.top <= solid.bottom:
        return None
    share = (min(solid.top, other.top) - solid.bottom) / (solid.top - solid.bottom)
    if share <= 0.0 or not measures.overlap(solid.bounds, other.bounds, BESIDE_M):
        return None
    apart = distance(solid.outline, other.outline)
    holds = apart <= limits.attached_m and share >= ALONGSIDE
    return Measure(holds, apart, share, limit=limits.attached_m)


def is_supported(space: Space, solid: Solid) -> bool:
    """Whether something holds it: from below, were it the floor of its place, or in its grasp."""
    if solid.name in space.holders:
        return True
    container, supports, place = space.spatial_relations(solid)
    if container is not None or supports:
        return True
    return place is not None and abs(solid.bottom - place[0].bottom) <= space.limits.gap_m
