"""Joints of bodies: hinges, slides and ball joints; how far open what they carry is, and which switch."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Final, Literal

from msgspec import Struct

from semmap.schemas import errors

OPEN_FROM: Final = 0.05
"""A thing counts as open from this share of the way on; less is a door that stands ajar by its play."""

ON_FROM: Final = 0.5
"""A switch counts as on from half of its way on."""

_SHUT: Final = 0.01

IS_OPEN: Final = "isOpen"
OPENNESS: Final = "openness"
JOINT_POSITIONS: Final = "jointPositions"
"""The properties by which a map states how its joints stand. Each says more than the one before."""
OPENING: Final = (IS_OPEN, OPENNESS, JOINT_POSITIONS)

IS_SWITCHED_ON: Final = "isSwitchedOn"
SWITCH_POSITIONS: Final = "switchPositions"
"""The same for those that switch something: `jointPositions` has all other joints."""
SWITCHING: Final = (IS_SWITCHED_ON, SWITCH_POSITIONS)

STANDING: Final = (*OPENING, *SWITCHING)
"""All by which a map states how joints stand."""


class Joint(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, omit_defaults=True):
    """A joint of a body, as it stands: a hinge or a slide with limits opens something, or switches it.

    `position` is an angle [rad] for a hinge, a distance [m] for a slide, and for a ball joint the angle
    [rad] by which it is turned away from its reference. `closed` is the limit at which what it carries is
    shut, or, if it is a `switch`, off; None for a joint that does neither: a ball, or one without limits.
    `initial` is where it stands before anybody moves it.
    """

    name: str
    kind: Literal["hinge", "slide", "ball"]
    position: float = 0.0
    lower: float | None = None
    upper: float | None = None
    closed: float | None = None
    initial: float = 0.0
    switch: bool = False

    @property
    def has_ends(self) -> bool:
        """Does it open or switch something?"""
        return self.closed is not None and self.lower is not None and self.upper is not None

    @property
    def opens(self) -> bool:
        """Does it open something?"""
        return self.has_ends and not self.switch

    @property
    def switches(self) -> bool:
        """Does it switch something?"""
        return self.has_ends and self.switch

    @property
    def open_end(self) -> float:
        """The limit at which what it carries is wide open, or on; only of one that has ends."""
        if self.lower is None:
            raise errors.InternalError("the joint has no lower limit")
        if self.upper is None:
            raise errors.InternalError("the joint has no upper limit")
        return self.upper if self.closed == self.lower else self.lower

    @property
    def openness(self) -> float | None:
        """The share of the way from shut to wide open, 0 to 1; None for a joint that opens nothing."""
        return self.openness_at(self.position)

    def openness_at(self, position: float) -> float | None:
        """What its openness would be at another position."""
        return self._share_at(position) if self.opens else None

    @property
    def share(self) -> float | None:
        """The share of its way, 0 to 1, from shut or off; None for one that neither opens nor switches."""
        return self._share_at(self.position) if self.has_ends else None

    def _share_at(self, position: float) -> float:
        if self.closed is None:
            raise errors.InternalError("the joint has no closed position")
        way = self.open_end - self.closed
        return min(1.0, max(0.0, (position - self.closed) / way)) if way else 0.0

    @property
    def is_on(self) -> bool | None:
        """Whether a switch is on; None for what is none."""
        return self._share_at(self.position) >= ON_FROM if self.switches else None

    def position_at(self, share: float) -> float:
        """Where it stands when it is so far open, or on; only of one that has ends."""
        if self.closed is None:
            raise errors.InternalError("the joint has no closed position")
        return self.closed + share * (self.open_end - self.closed)


def openness(joints: Iterable[Joint]) -> float | None:
    """How far open a thing is: as far as the joint that is open furthest; None if nothing of it opens."""
    return max((share for joint in joints if (share := joint.openness) is not None), default=None)


def is_on(joints: Iterable[Joint]) -> bool | None:
    """Whether a thing is switched on: any of its switches is; None if it has none."""
    found = [on for joint in joints if (on := joint.is_on) is not None]
    return any(found) if found else None


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

    Of the properties the most exact counts: one by one of switches and of all other joints.
    """
    joints = tuple(joints)
    switches = _switches_stated(joints, properties)
    others = _openings_stated(joints, properties)
    if switches is None and others is None:
        return None
    return {**(others or {}), **(switches or {})}


def wanted(joints: Iterable[Joint], properties: Mapping[str, object]) -> dict[str, float]:
    """Where joints are to stand, by name: as a map states; as they are made where it states nothing.

    Left out are those of which it says only what does not concern them, as that a thing is open of its wheel.
    """
    joints = tuple(joints)
    found = {joint.name: joint.initial for joint in joints}
    for kind, said in (
        ([joint.name for joint in joints if not joint.switches], _openings_stated(joints, properties)),
        ([joint.name for joint in joints if joint.switches], _switches_stated(joints, properties)),
    ):
        for name in kind if said is not None else ():
            del found[name]
        found.update({} if said is None else said)
    return found


def _switches_stated(joints: Iterable[Joint], properties: Mapping[str, object]) -> dict[str, float] | None:
    said, on = properties.get(SWITCH_POSITIONS), properties.get(IS_SWITCHED_ON)
    if isinstance(said, str):
        return positions_of(said)
    if not isinstance(on, bool):
        return None
    return {joint.name: joint.position_at(float(on)) for joint in joints if joint.switches}


def _openings_stated(joints: Iterable[Joint], properties: Mapping[str, object]) -> dict[str, float] | None:
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
    """How a joint stands: `door open to 50% (0.873 rad)`, `knob off (0 rad)`."""
    unit = "m" if joint.kind == "slide" else "rad"
    position, share = f"{round(joint.position, 3) + 0.0:g} {unit}", joint.openness
    if joint.is_on is not None:
        return f"{joint.name} {'on' if joint.is_on else 'off'} ({position})"
    if share is None:
        return f"{joint.name} at {position}"
    return f"{joint.name} {'closed' if share < _SHUT else f'open to {share:.0%}'} ({position})"
