"""Checks of commands that open or close an entity whose body has joints."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from typing import Final

from semmap.nodes.coordinator.commands.map_view import MapView
from semmap.schemas import errors
from semmap.schemas.commands import Set, Update
from semmap.schemas.joints import IS_OPEN, OPENNESS, Joint


def normalize_property(property_: str) -> str:
    """Return the common form of a property name: `isOpen`, `is open` and `is_open` are equal."""
    return property_.replace(" ", "").replace("_", "").lower()


_OPEN: Final = {normalize_property(IS_OPEN), normalize_property(OPENNESS)}


def require_openable(view: MapView, command: Set | Update) -> None:
    """Raise Refused if a command opens or closes a body with joints, none of which opens anything."""
    words = (command.property,) if isinstance(command, Set) else properties_in(command.set)
    body = view.bodies().get(command.name)
    if body is None or _OPEN.isdisjoint(normalize_property(re.split("[:#/]", word)[-1]) for word in words):
        return
    joints = [joint for joint in body.joints if not joint.switch]
    if joints and not any(joint.opens for joint in joints) and (why := explain_endless_joint(joints)):
        raise errors.Refused(
            f"{body.name} has no door, lid or drawer that could be open or shut{why};"
            f" for its joint positions, see jointPositions in: semmap get {body.name}"
        )


def properties_in(statements: Iterable[str]) -> tuple[str, ...]:
    """Return the property names of `PROPERTY=VALUE` assignments."""
    return tuple(word.partition("=")[0] for word in statements)


def explain_endless_joint(joints: Sequence[Joint]) -> str:
    """Return why joints without limits open nothing, or "" if all joints have limits."""
    joint = next((joint for joint in joints if not joint.has_ends), None)
    if joint is None:
        return ""
    why = "is a ball joint" if joint.kind == "ball" else "has no limits, so it has no closed position"
    return f": its joint {joint.name} {why}"
