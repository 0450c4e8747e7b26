"""Fixtures that are let into the top of another object, such as a sink in a counter."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from semmap.nodes.geometry.polygons import Point, contains
from semmap.nodes.kb_node.relations.geometry.forms import LOWEST_M
from semmap.nodes.kb_node.relations.geometry.solids import Solid
from semmap.nodes.kb_node.relations.measuring.measures import Measure, overlap
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds

_EDGE_M: Final = 0.02
"""How far outside the edge of a fixture the top is looked for."""
_ALONG: Final = (0.2, 0.5, 0.8)
"""Where on each side of the outline the top is looked for."""
_MOST_OF_EDGE: Final = 0.75
"""The least share of the edge that a top surrounds: three sides of a sink at the front of a counter."""


def may_be_recessed(inner: Solid, outer: Solid, limits: Thresholds) -> bool:
    """Return whether `measure_recess` may return a measurement. It is fast."""
    return (
        inner.is_fixed
        and inner.has_parts
        and outer.has_parts
        and inner.is_level
        and outer.is_level
        and inner.footprint < outer.footprint
        and outer.bottom <= inner.bottom < outer.top - limits.gap_m
    )


def measure_recess(inner: Solid, outer: Solid, limits: Thresholds) -> Measure | None:
    """Return the share of the edge of a fixture that a level top of another object surrounds.

    The fixture begins below the top, by more than the tolerance of a pose, and reaches up to it. It may also
    be higher, such as a sink with its tap. None if there is no such top.
    """
    if inner is outer or not may_be_recessed(inner, outer, limits) or not overlap(inner.bounds, outer.bounds):
        return None
    lowest, highest = inner.bottom + limits.gap_m, inner.top + limits.gap_m
    tops = [part for part in outer.parts if part.has_flat_top and lowest < part.high[2] <= highest]
    best: Measure | None = None
    points = list(_iterate_edge(inner))
    for height in sorted({part.high[2] for part in tops}, reverse=True):
        level = [part.projection for part in tops if abs(part.high[2] - height) <= LOWEST_M]
        share = sum(any(contains(top, point) for top in level) for point in points) / len(points)
        if share > 0.0 and (best is None or share > best.share):
            gap = inner.bottom - height
            best = Measure(share >= _MOST_OF_EDGE, gap, share, height, _MOST_OF_EDGE, by_edge=True)
    return best


def _iterate_edge(solid: Solid) -> Iterator[Point]:
    """Yield points just outside the outline of the box of a level solid."""
    corners = solid.outline
    x, y = (sum(along) / len(corners) for along in zip(*corners, strict=True))
    for (x0, y0), (x1, y1) in zip(corners, corners[1:] + corners[:1], strict=True):
        mid_x, mid_y = (x0 + x1) / 2 - x, (y0 + y1) / 2 - y
        beyond = _EDGE_M / max((mid_x * mid_x + mid_y * mid_y) ** 0.5, 1e-9)
        for share in _ALONG:
            yield x0 + share * (x1 - x0) + beyond * mid_x, y0 + share * (y1 - y0) + beyond * mid_y
