"""When a relation holds: the margins, and where their values come from."""

from __future__ import annotations

import math

from msgspec import Struct


class Thresholds(Struct, frozen=True, kw_only=True):
    """The margins of all relations. Lengths in metres, shares from 0 to 1."""

    gap_m: float = 0.05
    """Between a bottom and the surface it stands on; the map may be as far off the body."""
    contact_m: float = 0.0015
    """Between what touches; also between the surfaces that a thing rests on at once."""
    steepest_deg: float = 30.0
    """Between the vertical and the normal of a contact that carries."""
    base_share: float = 0.3
    """Of the base that is over the surface; a body that does not fall has about half."""
    inside_share: float = 0.5
    """Of the volume that is within the hollow."""
    place_share: float = 0.5
    """Of the footprint that is within the place."""
    touch_m: float = 0.01
    """Between two sides that touch."""
    near_share: float = 1.0
    """Of the mean length of the two things: a gap up to this is near."""
    near_most_m: float = 1.0
    """But never further apart than this."""
    beneath_share: float = 0.3
    """Of the lower thing's footprint that is beneath the other."""

    @property
    def upright(self) -> float:
        """The least vertical component of the normal of a contact that carries."""
        return math.cos(math.radians(self.steepest_deg))
