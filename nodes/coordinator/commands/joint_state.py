"""Checks of commands that open, close, switch or attach an entity whose body is in the scene."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Final

from semmap.nodes.coordinator.commands.map_view import MapView
from semmap.schemas import errors
from semmap.schemas.attachments import GRASPING
from semmap.schemas.commands import Command, Set, Unset, Update
from semmap.schemas.joints import IS_OPEN, OPENING, OPENNESS, SWITCHING, Joint
from semmap.schemas.scenes import Body


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


def require_not_of_scene(changes: Iterable[Command], bodies: Mapping[str, Body]) -> None:
    """Raise Refused, with the command to use, if a change states what the scene determines.

    These are joint positions, switches and attachments. This is for a scene that is the source of truth: the
    map would follow it and undo the change.
    """
    for change in changes:
        if isinstance(change, (Set, Unset)):
            words: tuple[str, ...] = (change.property,)
        elif isinstance(change, Update):
            words = (*properties_in(change.set), *properties_in(change.unset))
        else:
            continue
        if (body := bodies.get(change.name)) is None:
            continue
        stated = {normalize_property(re.split("[:#/]", word)[-1]) for word in words}
        if grip := [p for p in GRASPING if normalize_property(p) in stated]:
            raise errors.Refused(
                f"{grip[0]} of {body.name} follows from the scene, which is the source of truth"
                f" (--truth scene); to change it: semmap attach {body.name} --to HOLDER, or semmap detach"
            )
        for properties, joints in (
            (SWITCHING, [joint for joint in body.joints if joint.switches]),
            (OPENING, [joint for joint in body.joints if not joint.switch]),
        ):
            if joints and (found := [p for p in properties if normalize_property(p) in stated]):
                joint = f" --joint {joints[0].name}" if properties is SWITCHING else ""
                raise errors.Refused(
                    f"{found[0]} of {body.name} follows from the scene, which is the source of truth"
                    f" (--truth scene); to change it: semmap open {body.name}{joint}, or semmap close"
                )


def properties_in(statements: Iterable[str]) -> tuple[str, ...]:
    """Return the property names of `PROPERTY=VALUE` assignments."""
    return tuple(word.partition("=")[0] for word in statements)


def explain_endless_joint(joints: Sequence[Joint]) -> str:
    """Return why joints open nothing, or "" if all of them do."""
    joint = next((joint for joint in joints if not joint.has_ends), None)
    if joint is None:
        return ""
    if joint.kind == "ball":
        why = "is a ball joint"
    elif joint.lower is None or joint.upper is None:
        why = "has no limits, so it has no closed position"
    else:
        why = "is that of a robot, or coupled to another joint"
    return f": its joint {joint.name} {why}"
