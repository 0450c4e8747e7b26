"""When a relation holds: the margins, which stand in the TBox as annotations of its properties."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from typing import Final, NamedTuple

from msgspec import Struct

from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from semmap.schemas.explanations import Term


class Thresholds(Struct, frozen=True, kw_only=True):
    """The margins of all relations. Lengths in metres, shares from 0 to 1."""

    gap_m: float = 0.05
    """Between a bottom and the surface it stands on; the map may be as far off the body."""
    contact_m: float = 0.0015
    """Between what touches; also between the surfaces that a thing rests on at once."""
    steepest_deg: float = 30.0
    """Between the vertical and the normal of a contact that carries."""
    base_share: float = 0.25
    """Of the base that is over the surfaces, if its middle is not; what does not fall has about half."""
    inside_share: float = 0.5
    """Of the volume that is within the hollow."""
    place_share: float = 0.5
    """Of the footprint that is within the place."""
    touch_m: float = 0.01
    """How far the boxes of two may reach into one another that are one above the other."""
    near_share: float = 1.0
    """Of the mean length of the two things: a gap up to this is near."""
    near_most_m: float = 1.0
    """But never further apart than this."""
    beneath_share: float = 0.3
    """Of the smaller footprint that is over or under the other."""
    attached_m: float = 0.02
    """Between what hangs and what it hangs on."""

    @property
    def upright(self) -> float:
        """The least vertical component of the normal of a contact that carries."""
        return math.cos(math.radians(self.steepest_deg))


class Annotated(NamedTuple):
    """Where the TBox has a threshold, and what it may be."""

    property: str
    annotation: str
    field: str
    most: float


ANNOTATIONS: Final = (
    Annotated("isOn", "greatestGap", "gap_m", 1.0),
    Annotated("isOn", "leastShare", "base_share", 1.0),
    Annotated("isOn", "steepestNormal", "steepest_deg", 89.0),
    Annotated("touches", "greatestGap", "contact_m", 1.0),
    Annotated("isInside", "leastShare", "inside_share", 1.0),
    Annotated("isLocatedIn", "leastShare", "place_share", 1.0),
    Annotated("isUnder", "leastShare", "beneath_share", 1.0),
    Annotated("isNear", "greatestGap", "near_most_m", 100.0),
    Annotated("isNear", "greatestGapToSize", "near_share", 100.0),
    Annotated("isAttachedTo", "greatestGap", "attached_m", 1.0),
)


def read_thresholds(values: Callable[[Term, Term], Iterable[Term]]) -> Thresholds:
    """The thresholds that a TBox says, and the usual ones for what it does not say.

    `values(property, annotation)` are the objects of such triples. Raises BadRequest for no threshold.
    """
    said: dict[str, float] = {}
    for about in ANNOTATIONS:
        found = sorted(values(v.dm(about.property), v.dm(about.annotation)))
        if found:
            said[about.field] = _number(about, v.lexical(found[0]))
    return Thresholds(**said)


def _number(about: Annotated, text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0.0 <= value <= about.most:
        raise errors.BadRequest(
            f"the {about.annotation} of {about.property} is from 0 to {about.most:g}, not '{text}'"
        )
    return value
