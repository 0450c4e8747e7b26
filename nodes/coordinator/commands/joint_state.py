"""What may be stated of how far open a thing is whose body in the scene has joints."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from typing import Final

from semmap.nodes.coordinator.commands.map_view import MapView
from semmap.schemas import errors
from semmap.schemas.commands import Set, Update
from semmap.schemas.joints import IS_OPEN, OPENNESS, Joint


def normalize_property(property_: str) -> str:
    """`isOpen`, `is open` and `is_open` are one property."""
    return property_.replace(" ", "").replace("_", "").lower()


_OPEN: Final = {normalize_property(IS_OPEN), normalize_property(OPENNESS)}


def require_openable(view: MapView, command: Set | Update) -> None:
    """Raises Refused where it is to be open or shut what has a joint, and none that opens anything."""
    words = (command.property,) if isinstance(command, Set) else properties_in(command.set)
    body = view.bodies().get(command.name)
    if body is None or _OPEN.isdisjoint(normalize_property(re.split("[:#/]", word)[-1]) for word in words):
        return
    joints = [joint for joint in body.joints if not joint.switch]
    if joints and not any(joint.opens for joint in joints) and (why := explain_endless_joint(joints)):
        raise errors.Refused(
            f"{body.name} has no door, lid or drawer that could be open or shut{why};"
            f" how it stands is told by jointPositions: semmap get {body.name}"
        )


def properties_in(statements: Iterable[str]) -> tuple[str, ...]:
    """The properties of `PROPERTY=VALUE`."""
    return tuple(word.partition("=")[0] for word in statements)


def explain_endless_joint(joints: Sequence[Joint]) -> str:
    """Why joints open nothing, of one of them that has no ends; nothing where there is none."""
    joint = next((joint for joint in joints if not joint.has_ends), None)
    if joint is None:
        return ""
    why = "is a ball joint" if joint.kind == "ball" else "has no limits, of which one could be the closed one"
    return f": its joint {joint.name} {why}"
