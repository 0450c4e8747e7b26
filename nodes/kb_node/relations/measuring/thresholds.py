"""Thresholds of the relations, read from annotations of the properties in the TBox."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from typing import Final, NamedTuple

from msgspec import Struct

from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.explanations import Term


class Thresholds(Struct, frozen=True, kw_only=True):
    """The thresholds of all relations. Lengths in metres, shares from 0 to 1."""

    gap_m: float = 0.05
    """Between a bottom and its supporting surface. The map may differ this much from the body."""
    contact_m: float = 0.0015
    """Between objects that touch, and between the surfaces that support one object together."""
    steepest_deg: float = 30.0
    """Between the vertical and the normal of a supporting contact."""
    base_share: float = 0.25
    """Share of the base over the surfaces if its centre is not. A stable object has about half."""
    inside_share: float = 0.5
    """Share of the volume within the hollow."""
    place_share: float = 0.5
    """Share of the footprint within the place."""
    touch_m: float = 0.01
    """Allowed overlap of the boxes of two objects one above the other."""
    near_share: float = 1.0
    """The greatest gap of near objects, relative to the mean length of both."""
    near_most_m: float = 1.0
    """The greatest gap of near objects."""
    beneath_share: float = 0.3
    """Share of the smaller footprint that is over or under the other."""
    attached_m: float = 0.02
    """Between an attached object and what it is attached to."""
    lean_gap_m: float = 0.05
    """Between a leaning object and what it leans against, as `gap_m`."""
    lean_deg: float = 5.0
    """Between the vertical and the line from the base of a leaning object to the contact."""

    @property
    def upright(self) -> float:
        """Return the least vertical component of the normal of a supporting contact."""
        return math.cos(math.radians(self.steepest_deg))


class AnnotatedThreshold(NamedTuple):
    """The annotation that holds a threshold, and its upper bound."""

    property: str
    annotation: str
    field: str
    most: float


ANNOTATIONS: Final = (
    AnnotatedThreshold("isOn", "greatestGap", "gap_m", 1.0),
    AnnotatedThreshold("isOn", "leastShare", "base_share", 1.0),
    AnnotatedThreshold("isOn", "steepestNormal", "steepest_deg", 89.0),
    AnnotatedThreshold("touches", "greatestGap", "contact_m", 1.0),
    AnnotatedThreshold("isInside", "leastShare", "inside_share", 1.0),
    AnnotatedThreshold("isLocatedIn", "leastShare", "place_share", 1.0),
    AnnotatedThreshold("isUnder", "leastShare", "beneath_share", 1.0),
    AnnotatedThreshold("isNear", "greatestGap", "near_most_m", 100.0),
    AnnotatedThreshold("isNear", "greatestGapToSize", "near_share", 100.0),
    AnnotatedThreshold("isAttachedTo", "greatestGap", "attached_m", 1.0),
    AnnotatedThreshold("isLeaningAgainst", "greatestGap", "lean_gap_m", 1.0),
    AnnotatedThreshold("isLeaningAgainst", "leastTilt", "lean_deg", 45.0),
)


def read_thresholds(values: Callable[[Term, Term], Iterable[Term]]) -> Thresholds:
    """Return the thresholds of a TBox, with defaults for missing ones.

    `values(property, annotation)` returns the objects of such triples. Raises BadRequest for an invalid
    one.
    """
    found_values: dict[str, float] = {}
    for about in ANNOTATIONS:
        found = sorted(values(v.dm(about.property), v.dm(about.annotation)))
        if found:
            found_values[about.field] = _parse_number(about, v.lexical(found[0]))
    return Thresholds(**found_values)


def _parse_number(about: AnnotatedThreshold, text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0.0 <= value <= about.most:
        raise errors.BadRequest(
            f"invalid {about.annotation} of {about.property}: '{text}'; use a number from 0 to {about.most:g}"
        )
    return value
