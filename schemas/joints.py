"""Joints of bodies: hinges, slides and ball joints, with their openness and switch states."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Iterable, Mapping
from typing import Final, Literal

from msgspec import Struct

from semmap.schemas import errors

OPEN_FROM: Final = 0.05
"""The share of the range from which an object counts as open; less can be the play of a closed door."""

ON_FROM: Final = 0.5
"""The share of the range from which a switch counts as on."""

_SHUT: Final = 0.01

IS_OPEN: Final = "isOpen"
OPENNESS: Final = "openness"
JOINT_POSITIONS: Final = "jointPositions"
"""The properties for the positions of joints that open something, each more precise than the previous one."""
OPENING: Final = (IS_OPEN, OPENNESS, JOINT_POSITIONS)

IS_SWITCHED_ON: Final = "isSwitchedOn"
SWITCH_POSITIONS: Final = "switchPositions"
"""The same for switches; `jointPositions` contains all other joints."""
SWITCHING: Final = (IS_SWITCHED_ON, SWITCH_POSITIONS)

STANDING: Final = (*OPENING, *SWITCHING)
"""All properties for joint positions."""


class Joint(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, omit_defaults=True):
    """A joint of a body with its position. A hinge or slide with limits opens something or is a switch.

    `position` is an angle [rad] for a hinge, a distance [m] for a slide, and for a ball joint the angle [rad]
    of rotation from its reference. `closed` is the limit at which the moved part is closed, or a `switch` is
    off. It is None for other joints: ball joints, and joints without limits. `initial` is the initial
    position.
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
        """Whether it opens or switches something."""
        return self.closed is not None and self.lower is not None and self.upper is not None

    @property
    def opens(self) -> bool:
        """Whether it opens something."""
        return self.has_ends and not self.switch

    @property
    def switches(self) -> bool:
        """Whether it is a switch."""
        return self.has_ends and self.switch

    @property
    def open_end(self) -> float:
        """The limit at which it is fully open or on; only for joints with `has_ends`."""
        if self.lower is None:
            raise errors.InternalError("the joint has no lower limit")
        if self.upper is None:
            raise errors.InternalError("the joint has no upper limit")
        return self.upper if self.closed == self.lower else self.lower

    @property
    def openness(self) -> float | None:
        """The position between closed and fully open, 0 to 1; None for a joint that opens nothing."""
        return self.openness_at(self.position)

    def openness_at(self, position: float) -> float | None:
        """Return the openness at another position."""
        return self._share_at(position) if self.opens else None

    @property
    def share(self) -> float | None:
        """The position between closed (or off) and open (or on), 0 to 1; None for other joints."""
        return self._share_at(self.position) if self.has_ends else None

    def _share_at(self, position: float) -> float:
        if self.closed is None:
            raise errors.InternalError("the joint has no closed position")
        way = self.open_end - self.closed
        return min(1.0, max(0.0, (position - self.closed) / way)) if way else 0.0

    @property
    def is_on(self) -> bool | None:
        """Whether a switch is on; None for other joints."""
        return self._share_at(self.position) >= ON_FROM if self.switches else None

    def position_at(self, share: float) -> float:
        """Return the position for a share of its range; only for joints with `has_ends`."""
        if self.closed is None:
            raise errors.InternalError("the joint has no closed position")
        return self.closed + share * (self.open_end - self.closed)


def openness(joints: Iterable[Joint]) -> float | None:
    """Return the openness of the joint that is open furthest, or None if no joint opens something."""
    return max((share for joint in joints if (share := joint.openness) is not None), default=None)


def is_on(joints: Iterable[Joint]) -> bool | None:
    """Return whether any of the switches is on, or None if there are none."""
    found = [on for joint in joints if (on := joint.is_on) is not None]
    return any(found) if found else None


def positions_text(joints: Iterable[Joint]) -> str:
    """Return positions as a property value, `door=1.571 drawer=0.2`: radians and metres, to a thousandth."""
    return " ".join(f"{joint.name}={round(joint.position, 3) + 0.0:g}" for joint in joints)


def positions_of(text: str) -> dict[str, float]:
    """Parse positions in a property value, by joint name; malformed words are ignored."""
    found = {}
    for word in text.split():
        name, equals, number = word.rpartition("=")
        with contextlib.suppress(ValueError):
            position = float(number)
            if name and equals and math.isfinite(position):
                found[name] = position
    return found


def stated(joints: Iterable[Joint], properties: Mapping[str, object]) -> dict[str, float] | None:
    """Return the asserted joint positions by name, or None if no property sets them.

    The most precise property is used, separately for switches and for all other joints.
    """
    joints = tuple(joints)
    switches = _switches_stated(joints, properties)
    others = _openings_stated(joints, properties)
    if switches is None and others is None:
        return None
    return {**(others or {}), **(switches or {})}


def select_joint_properties(properties: Mapping[str, object]) -> dict[str, bool | float | str]:
    """Return the properties that set joint positions."""
    return {
        name: value for name in STANDING if isinstance(value := properties.get(name), (bool, int, float, str))
    }


def wanted(joints: Iterable[Joint], properties: Mapping[str, object]) -> dict[str, float]:
    """Return the desired joint positions by name: the asserted ones, or the initial ones without assertions.

    Joints that the assertions do not concern, such as the wheels of an object that is open, are left out.
    """
    joints = tuple(joints)
    found = {joint.name: joint.initial for joint in joints}
    for kind, asserted in (
        ([joint.name for joint in joints if not joint.switches], _openings_stated(joints, properties)),
        ([joint.name for joint in joints if joint.switches], _switches_stated(joints, properties)),
    ):
        for name in kind if asserted is not None else ():
            del found[name]
        found.update({} if asserted is None else asserted)
    return found


def _switches_stated(joints: Iterable[Joint], properties: Mapping[str, object]) -> dict[str, float] | None:
    text, on = properties.get(SWITCH_POSITIONS), properties.get(IS_SWITCHED_ON)
    if isinstance(text, str):
        return positions_of(text)
    if not isinstance(on, bool):
        return None
    return {joint.name: joint.position_at(float(on)) for joint in joints if joint.switches}


def _openings_stated(joints: Iterable[Joint], properties: Mapping[str, object]) -> dict[str, float] | None:
    text = properties.get(JOINT_POSITIONS)
    if isinstance(text, str):
        return positions_of(text)
    share = properties.get(OPENNESS)
    if isinstance(share, bool) or not isinstance(share, (int, float)):
        is_open = properties.get(IS_OPEN)
        if not isinstance(is_open, bool):
            return None
        share = float(is_open)
    share = min(1.0, max(0.0, float(share)))
    return {joint.name: joint.position_at(share) for joint in joints if joint.opens}


def in_words(joint: Joint) -> str:
    """Return a text about a joint: `door open to 50% (0.873 rad)`, `knob off (0 rad)`."""
    unit = "m" if joint.kind == "slide" else "rad"
    position, share = f"{round(joint.position, 3) + 0.0:g} {unit}", joint.openness
    if joint.is_on is not None:
        return f"{joint.name} {'on' if joint.is_on else 'off'} ({position})"
    if share is None:
        return f"{joint.name} at {position}"
    return f"{joint.name} {'closed' if share < _SHUT else f'open to {share:.0%}'} ({position})"
