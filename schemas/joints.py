"""Joints of bodies: hinges, slides and ball joints, and how far open what they carry is."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Final, Literal

from msgspec import Struct

OPEN_FROM: Final = 0.05
"""A thing counts as open from this share of the way on; less is a door that stands ajar by its play."""

_SHUT: Final = 0.01

IS_OPEN: Final = "isOpen"
OPENNESS: Final = "openness"
JOINT_POSITIONS: Final = "jointPositions"
"""The properties by which a map states how its joints stand. Each says more than the one before."""
OPENING: Final = (IS_OPEN, OPENNESS, JOINT_POSITIONS)


class Joint(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, omit_defaults=True):
    """A joint of a body, as it stands: a hinge or a slide with limits opens something.

    `position` is an angle [rad] for a hinge, a distance [m] for a slide, and for a ball joint the angle
    [rad] by which it is turned away from its reference. `closed` is the limit at which what it carries is
    shut; None for a joint that opens nothing: a ball, or one without limits. `initial` is where it stands
    before anybody moves it.
    """

    name: str
    kind: Literal["hinge", "slide", "ball"]
    position: float = 0.0
    lower: float | None = None
    upper: float | None = None
    closed: float | None = None
    initial: float = 0.0

    @property
    def opens(self) -> bool:
        """Does it open something?"""
        return self.closed is not None and self.lower is not None and self.upper is not None

    @property
    def open_end(self) -> float:
        """The limit at which what it carries is wide open; only of one that opens something."""
        assert self.lower is not None
        assert self.upper is not None
        return self.upper if self.closed == self.lower else self.lower

    @property
    def openness(self) -> float | None:
        """The share of the way from shut to wide open, 0 to 1; None for a joint that opens nothing."""
        return self.openness_at(self.position)

    def openness_at(self, position: float) -> float | None:
        """What its openness would be at another position."""
        if not self.opens:
            return None
        assert self.closed is not None
        return min(1.0, max(0.0, (position - self.closed) / (self.open_end - self.closed)))

    def position_at(self, openness: float) -> float:
        """Where it stands when it is so far open; only of one that opens something."""
        assert self.closed is not None
        return self.closed + openness * (self.open_end - self.closed)


def openness(joints: Iterable[Joint]) -> float | None:
    """How far open a thing is: as far as the joint that is open furthest; None if nothing of it opens."""
    return max((share for joint in joints if (share := joint.openness) is not None), default=None)


def positions_text(joints: Iterable[Joint]) -> str:
    """Positions as a map states them, `door=1.571 drawer=0.2`: in radians and metres, to a thousandth."""
    return " ".join(f"{joint.name}={round(joint.position, 3) + 0.0:g}" for joint in joints)


def positions_of(text: str) -> dict[str, float]:
    """Positions as a map states them, by the joint's name; what is not written so is passed over."""
    found = {}
    for word in text.split():
        name, equals, number = word.rpartition("=")
        try:
            found[name] = float(number)
        except ValueError:
            continue
        if not (name and equals):
            del found[name]
    return found


def stated(joints: Iterable[Joint], properties: Mapping[str, object]) -> dict[str, float] | None:
    """Where a map states that joints stand, by name; None where it states nothing of the kind.

    Of the properties the most exact counts.
    """
    said = properties.get(JOINT_POSITIONS)
    if isinstance(said, str):
        return positions_of(said)
    share = properties.get(OPENNESS)
    if isinstance(share, bool) or not isinstance(share, (int, float)):
        is_open = properties.get(IS_OPEN)
        if not isinstance(is_open, bool):
            return None
        share = float(is_open)
    share = min(1.0, max(0.0, float(share)))
    return {joint.name: joint.position_at(share) for joint in joints if joint.opens}


def in_words(joint: Joint) -> str:
    """How a joint stands: `door open to 50% (0.873 rad)`."""
    unit = "m" if joint.kind == "slide" else "rad"
    position, share = f"{round(joint.position, 3) + 0.0:g} {unit}", joint.openness
    if share is None:
        return f"{joint.name} at {position}"
    return f"{joint.name} {'closed' if share < _SHUT else f'open to {share:.0%}'} ({position})"
