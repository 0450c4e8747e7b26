"""Resolves `on`, `in` and `next_to` of a command to a free pose, which the knowledge base finds."""

from __future__ import annotations

from typing import Final, NamedTuple, TypeVar

from msgspec import structs

from semmap.nodes.coordinator.commands.attachment_rules import resolve_name
from semmap.nodes.coordinator.commands.map_view import MapView
from semmap.nodes.coordinator.kb_coroutines import KbCoroutine, ask
from semmap.schemas import errors
from semmap.schemas.bridge import FindRoom, Room
from semmap.schemas.commands import Add, Move, Update
from semmap.schemas.entities import ClassInfo, Entity, Quaternion, orientation_from_yaw
from semmap.schemas.relations import Placing, placing_words

Placed = TypeVar("Placed", bound=Add | Update | Move)

_FIELDS: Final[dict[str, Placing]] = {"on": "on", "in_": "in", "next_to": "next_to"}


class Wanted(NamedTuple):
    """How an object is to be placed, and relative to which one."""

    placing: Placing
    target: str


def placing_of(command: Add | Update | Move) -> Wanted | None:
    """Return how the command places its object relative to another one, or None.

    Raises BadRequest if it also gives a position, or places it twice.
    """
    given = [Wanted(how, to) for name, how in _FIELDS.items() if (to := getattr(command, name)) is not None]
    if not given:
        return None
    options = [f"--{wanted.placing.replace('_', '-')}" for wanted in given]
    if command.at is not None:
        options.append("--at")
    if not isinstance(command, Move) and command.extent is not None:
        options.append("--extent")
    if len(options) > 1:
        raise errors.BadRequest(f"give only one of {' and '.join(options)}")
    return given[0]


def make_request(
    view: MapView, command: Add | Update | Move, wanted: Wanted, name: str, found: ClassInfo | None
) -> FindRoom:
    """Return the request for a free pose of entity `name`, whose class is or becomes `found`.

    Raises UnknownName for the target, and Refused for a place and for the entity itself.
    """
    target = view.entity(resolve_name(wanted.target, view.entities))
    entity = view.entities.get(name)
    how = placing_words(wanted.placing)
    if target.name == name:
        raise errors.Refused(f"{name} cannot be placed {how} itself; name another entity")
    if found.place if found is not None else entity is not None and entity.place:
        raise errors.Refused(f"{name} is a place and is not placed {how} an object; give --at or --extent")
    return FindRoom(
        name=name,
        model=None if found is None else found.model,
        size_m=None if isinstance(command, Move) else command.size,
        orientation=_orientation(command, entity),
        placing=wanted.placing,
        target=target.name,
        carry=False if isinstance(command, Add) else command.carry,
    )


def at_room(command: Placed, room: Room) -> Placed:
    """Return the command with the pose that was found."""
    at, orientation = room.pose.position_m, room.pose.orientation_wxyz
    cleared = structs.replace(command, at=at, on=None, in_=None, next_to=None)
    return (
        cleared if isinstance(command, Move) else structs.replace(cleared, yaw=None, orientation=orientation)
    )


def place(
    view: MapView, command: Placed, name: str, found: ClassInfo | None
) -> KbCoroutine[tuple[Placed, str, tuple[str, ...]]]:
    """Return the command with a position, where that is (` on table1`), and notes; others as they are."""
    wanted = placing_of(command)
    if wanted is None:
        return command, "", ()
    request = make_request(view, command, wanted, name, found)
    room = yield from ask(request)
    where = f" {placing_words(wanted.placing)} {request.target}"
    return at_room(command, room), where, (room.note,) if room.note else ()


def _orientation(command: Add | Update | Move, entity: Entity | None) -> Quaternion | None:
    """Return the orientation that is given, or that an entity in the map keeps."""
    if command.yaw is not None:
        return orientation_from_yaw(command.yaw)
    if not isinstance(command, Move) and command.orientation is not None:
        return command.orientation
    return None if entity is None or entity.pose is None else entity.pose.orientation_wxyz
