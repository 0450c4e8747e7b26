"""Whether an object is in a place, which is a box or a polygon."""

from __future__ import annotations

from semmap.nodes.geometry.polygons import area, clipped, contains, covers
from semmap.nodes.geometry.regions import Region
from semmap.nodes.kb_node.relations.geometry.solids import Solid
from semmap.nodes.kb_node.relations.measuring.measures import Measure, is_rectangle_within, overlap
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds


def within(solid: Solid, place: Solid, limits: Thresholds, *, also_places: bool = False) -> Measure | None:
    """Return the share of a footprint within a place, or of a position if the size is unknown.

    None if `place` is not a place with an extent. None also if `solid` is a place, unless with
    `also_places`.
    """
    if not place.is_place or not place.is_measured or (solid.is_place and not also_places):
        return None
    height = solid.centre[2] if solid.is_measured else solid.position[2]
    limit = limits.place_share
    if not place.bottom - limits.gap_m <= height <= place.top + limits.gap_m:
        return Measure(False, share=0.0, limit=limit)
    if place.form.region is not None:
        share = _compute_share_in_region(solid, place, place.form.region)
    elif not solid.is_measured:
        share = float(contains(place.outline, solid.position[:2]))
    elif not overlap(solid.bounds, place.bounds):
        share = 0.0
    elif solid.form.region is not None:
        share = solid.form.region.shared(place.outline, solid.position[:2]) / max(solid.footprint, 1e-9)
    elif (place.form.is_square and is_rectangle_within(solid.bounds, place.bounds)) or covers(
        place.outline, solid.outline
    ):
        share = 1.0
    else:
        share = area(clipped(solid.outline, place.outline)) / max(area(solid.outline), 1e-9)
    return Measure(share >= limit, share=share, limit=limit)


def _compute_share_in_region(solid: Solid, place: Solid, region: Region) -> float:
    """Return the share of a footprint, or of a position without a size, that a polygon covers."""
    x, y, _ = place.position
    if not solid.is_measured:
        px, py, _ = solid.position
        return float(region.contains((px - x, py - y)))
    if not overlap(solid.bounds, place.bounds):
        return 0.0
    if (its := solid.form.region) is not None:
        to = (x - solid.position[0], y - solid.position[1])
        shared = sum(region.shared(piece.corners, to) for piece in its.pieces)
        return min(1.0, shared / max(its.area, 1e-9))
    return min(1.0, region.shared(solid.outline, (x, y)) / max(area(solid.outline), 1e-9))
