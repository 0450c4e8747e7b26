"""Resolves `on`, `in` and `next_to` of a command to a free pose, which the knowledge base finds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final, NamedTuple, TypeVar

from msgspec import structs

from semmap.nodes.coordinator.commands.attachment_rules import resolve_name
from semmap.nodes.coordinator.commands.map_view import MapView
from semmap.nodes.coordinator.kb_coroutines import KbCoroutine, ask
from semmap.schemas import errors
from semmap.schemas.bridge import FindRoom, PlacedObject, Room
from semmap.schemas.commands import Add, Move, Update
from semmap.schemas.entities import ClassInfo, Entity, Pose, Quaternion, orientation_from_yaw
from semmap.schemas.relations import Placing, placing_words
from semmap.schemas.scene_files import Described, pose_of

Placed = TypeVar("Placed", bound=Add | Update | Move)
Placeable = Add | Update | Move | Described
"""What has the fields `on`, `in_` and `next_to`."""
Named = tuple[str, Described, ClassInfo]
"""An entity of a scene with its name and class."""

_FIELDS: Final[dict[str, Placing]] = {"on": "on", "in_": "in", "next_to": "next_to"}


class Wanted(NamedTuple):
    """How an object is to be placed, and relative to which one."""

    placing: Placing
    target: str


def placing_of(command: Placeable) -> Wanted | None:
    """Return how the command places its object relative to another one, or None.

    Raises BadRequest if it also gives a position, or places it twice.
    """
    given = [Wanted(how, to) for name, how in _FIELDS.items() if (to := getattr(command, name)) is not None]
    if not given:
        return None
    ways: list[str] = [wanted.placing for wanted in given]
    if command.at is not None:
        ways.append("at")
    if not isinstance(command, Move) and command.extent is not None:
        ways.append("extent")
    if len(ways) > 1:
        is_file = isinstance(command, Described)
        words = ways if is_file else [f"--{way.replace('_', '-')}" for way in ways]
        raise errors.BadRequest(f"give only one of {' and '.join(words)}")
    return given[0]


def make_request(
    view: MapView, command: Add | Update | Move, wanted: Wanted, name: str, found: ClassInfo | None
) -> FindRoom:
    """Return the request for a free pose of entity `name`, whose class is or becomes `found`.

    Raises UnknownName for the target, and Refused for a place and for the entity itself.
    """
    target = view.entity(resolve_name(wanted.target, view.entities)).name
    entity = view.entities.get(name)
    is_place = found.place if found is not None else entity is not None and entity.place
    _require_placeable(name, wanted, target, is_place=is_place)
    return FindRoom(
        name=name,
        model=None if found is None else found.model,
        size_m=None if isinstance(command, Move) else command.size,
        orientation=_orientation(command, entity),
        placing=wanted.placing,
        target=target,
        carry=False if isinstance(command, Add) else command.carry,
    )


def _require_placeable(name: str, wanted: Wanted, target: str, *, is_place: bool) -> None:
    how = placing_words(wanted.placing)
    if target == name:
        raise errors.Refused(f"{name} cannot be placed {how} itself; name another entity")
    if is_place:
        raise errors.Refused(f"{name} is a place and is not placed {how} an object; give --at or --extent")


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


def _orientation(command: Placeable, entity: Entity | None) -> Quaternion | None:
    """Return the orientation that is given, or that an entity in the map keeps."""
    if command.yaw is not None:
        return orientation_from_yaw(command.yaw)
    if not isinstance(command, Move) and command.orientation is not None:
        return command.orientation
    return None if entity is None or entity.pose is None else entity.pose.orientation_wxyz


def place_described(
    items: Sequence[Named], there: Mapping[str, Entity], *, replace: bool
) -> KbCoroutine[tuple[list[Named], tuple[str, ...]]]:
    """Return the entities of a scene with positions, in their order, and notes.

    Those with `on`, `in` or `next_to` are placed; entities before them in the file take up room. `there` are
    the entities of the map that stay; with `replace` there are none. Raises BadRequest, UnknownName, Refused.
    """
    placed: list[Named] = []
    others: dict[str, PlacedObject] = {}
    notes: dict[str, None] = {}
    for name, given, found in items:
        wanted, item = placing_of(given), given
        if wanted is not None:
            target = resolve_name(wanted.target, there)
            if target not in there and target not in others:
                hint = errors.did_you_mean(target, [*there, *others])
                raise errors.UnknownName(
                    f"{name}: no entity before it in the file or in the map is named '{target}'{hint}"
                )
            _require_placeable(name, wanted, target, is_place=found.place)
            request = FindRoom(
                name=name,
                model=None if name in there else found.model,
                size_m=item.size,
                orientation=_orientation(item, there.get(name)),
                placing=wanted.placing,
                target=target,
                others=tuple(others.values()),
                alone=replace,
                stays=True,
            )
            room = yield from ask(request)
            item = _at_pose(item, room.pose)
            if room.note:
                notes[room.note] = None
        placed.append((name, item, found))
        if item.at is not None:
            pose = pose_of(item.at, item.yaw, item.orientation)
            others[name] = PlacedObject(
                name=name, model=found.model, pose=pose, size_m=item.size, place=found.place
            )
    return placed, tuple(notes)


def _at_pose(item: Described, pose: Pose) -> Described:
    at, orientation = pose.position_m, pose.orientation_wxyz
    return structs.replace(item, at=at, yaw=None, orientation=orientation, on=None, in_=None, next_to=None)
