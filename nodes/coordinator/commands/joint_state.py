"""Checks of commands that open, close, switch or attach an entity whose body is in the scene."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from typing import Final

from msgspec import structs

from semmap.nodes.coordinator.commands.map_view import MapView
from semmap.schemas import errors
from semmap.schemas.attachments import GRASPING
from semmap.schemas.commands import Batch, Set, Unset, Update
from semmap.schemas.commits import Reserved, Transaction
from semmap.schemas.joints import IS_OPEN, OPENING, OPENNESS, SWITCHING, Joint
from semmap.schemas.scenes import Body


def normalize_property(property_: str) -> str:
    """Return the common form of a property name: `isOpen`, `is open` and `is_open` are equal."""
    return property_.replace(" ", "").replace("_", "").lower()


_STATING: Final = {command.VERB for command in (Batch, Set, Unset, Update)}
_OF_SCENE: Final = "follows from the scene, which is the source of truth (--truth scene)"
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


def reserve_for_scene(transaction: Transaction, bodies: Mapping[str, Body]) -> Transaction:
    """Return the transaction of a command, rejected if it states what the scene determines.

    These are joint positions, switches and attachments; the error has the command to use. This is for a scene
    that is the source of truth: the map would follow it and undo the change.
    """
    if transaction.verb not in _STATING or not any(edit.set or edit.unset for edit in transaction.edit):
        return transaction
    reserved = defaultdict[tuple[tuple[str, ...], str], list[str]](list)
    for name, body in bodies.items():
        reserved[GRASPING, "semmap attach {name} --to HOLDER, or semmap detach"].append(name)
        if switches := [joint for joint in body.joints if joint.switches]:
            how = f"semmap open {{name}} --joint {switches[0].name}, or semmap close"
            reserved[SWITCHING, how].append(name)
        if any(not joint.switch for joint in body.joints):
            reserved[OPENING, "semmap open {name}, or semmap close"].append(name)
    return structs.replace(
        transaction,
        reserved=tuple(
            Reserved(names=tuple(names), properties=properties, why=f"{_OF_SCENE}; to change it: {how}")
            for (properties, how), names in reserved.items()
        ),
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
