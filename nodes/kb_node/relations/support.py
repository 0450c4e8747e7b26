"""Supports and contents of an object, and the height of an object that nothing supports."""

from __future__ import annotations

from collections.abc import Iterator

from semmap.nodes.kb_node.relations.geometry.solids import Solid
from semmap.nodes.kb_node.relations.measuring import support_contact
from semmap.nodes.kb_node.relations.measuring.arrangement import find_attachments, is_supported
from semmap.nodes.kb_node.relations.measuring.phrases import format_height, format_length
from semmap.nodes.kb_node.relations.measuring.space import Found, Space
from semmap.schemas.relations import Relation, RelationName


def find_supporters(space: Space, solid: Solid) -> set[Solid]:
    """Return what an object is on or inside, directly or through other objects."""
    found, waiting = set[Solid](), [solid]
    while waiting:
        below = {*space.spatial_relations(waiting.pop()).supporters} - found
        found |= below
        waiting += below
    return found


def find_contents(space: Space, solid: Solid) -> Iterator[tuple[RelationName, Solid, Found]]:
    """Yield what is directly inside an object or on it, ordered by name.

    In a crowd only the largest are considered. A place has no contents.
    """
    if solid.is_place:
        return
    around = (o for o in space.counted_around(solid) if not o.is_place and space.may_support(solid, o))
    for upper in sorted(around, key=lambda other: other.name):
        container, supports, _ = space.spatial_relations(upper)
        if container is not None and container[0] is solid:
            yield "isInside", upper, container
        for support in supports:
            if support[0] is solid:
                yield "isOn", upper, support


def describe_unsupported(space: Space, solid: Solid) -> Relation | None:
    """Return a negative `isOn` relation with the height of an unsupported object, else None.

    An object of unknown size yields a relation whose text asks for the size. A flat map has no height
    information.
    """
    if solid.is_place:
        return None
    if not solid.is_measured:
        reason = (
            "its size is unknown, so only its place can be computed;"
            f" set a size: semmap update {solid.name} --size X Y Z"
        )
        return _make_relation(solid, f"{solid.name} has no known support: {reason}")
    if space.is_flat or space.is_crowded(solid) or is_supported(space, solid):
        return None
    if next(find_attachments(space, solid), None) is not None:
        return None
    _, _, place = space.spatial_relations(solid)
    floor_m = solid.bottom - (0.0 if place is None else place[0].bottom)
    if place is None and abs(floor_m) <= space.limits.gap_m:
        return None  # assumed to be the ground
    if (nearest := _find_nearest_surface(space, solid, floor_m)) is not None:
        other, made = nearest
        reason = f"its bottom is {format_height(made.gap_m)} a surface of {other.name}"
        if made.gap_m <= space.limits.gap_m:
            reason += f", but {made.share:.0%} of its base is over it"
        return _make_relation(solid, f"{solid.name} is on nothing: {reason}", made.gap_m, made.share)
    if place is None:
        reason = (
            f"its bottom is at a height of {format_length(floor_m)}, and it is not in a place with a floor"
        )
    else:
        reason = f"its bottom is {format_height(floor_m)} the floor of {place[0].name}"
    return _make_relation(solid, f"{solid.name} is on nothing: {reason}", floor_m)


def _find_nearest_surface(space: Space, solid: Solid, floor_m: float) -> Found | None:
    """Return the surface nearest to the bottom of an object, or None if the floor is nearer."""
    found: Found | None = None
    nearest = abs(floor_m)
    for other in space.counted_around(solid):
        made = None if other.is_place else support_contact.over(solid, other, space.limits)
        if made is None or abs(made.gap_m) >= nearest or made.gap_m <= solid.bottom - solid.top:
            continue
        if solid not in find_supporters(space, other):  # such as a cup on the board of a wall cabinet
            found, nearest = (other, made), abs(made.gap_m)
    return found


def _make_relation(solid: Solid, text: str, gap_m: float = 0.0, share: float = 0.0) -> Relation:
    return Relation(
        relation="isOn",
        subject=solid.name,
        object="",
        holds=False,
        gap_m=round(gap_m, 4) + 0.0,
        share=round(share, 4),
        text=text,
    )
