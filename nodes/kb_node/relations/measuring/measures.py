"""Measurements of relations between two solids. None means that a relation cannot be measured.

*On* and *in* are grounded in support and containment, not in overlapping boxes (Richard-Bollans et al.
2019).
"""

from __future__ import annotations

from typing import NamedTuple

from semmap.nodes.kb_node.relations.geometry.forms import Bounds


class Measure(NamedTuple):
    """Whether a relation holds between two solids, with the measured values."""

    holds: bool
    gap_m: float = 0.0
    """Distance between the two. For *on*: height of the bottom above the surface, negative below it."""
    share: float = 1.0
    """Share of the first one's base, volume or footprint, depending on the relation."""
    height_m: float = 0.0
    """Height of the surface in the map."""
    limit: float = 0.0
    """The greatest gap, or least share, for which the relation holds."""
    by_base: bool = False
    """Whether the share is of the base, for an object that stands in a container and sticks out of it."""
    by_edge: bool = False
    """Whether the share is of the edge, for a fixture that is let into a top."""


def is_rectangle_within(one: Bounds, other: Bounds) -> bool:
    """Return whether one axis-aligned rectangle is within another."""
    return one[0] >= other[0] and one[1] >= other[1] and one[2] <= other[2] and one[3] <= other[3]


def overlap(one: Bounds, other: Bounds, margin_m: float = 0.0) -> bool:
    """Return whether two axis-aligned rectangles meet or are within a margin."""
    return (
        one[0] - margin_m <= other[2]
        and other[0] - margin_m <= one[2]
        and one[1] - margin_m <= other[3]
        and other[1] - margin_m <= one[3]
    )
