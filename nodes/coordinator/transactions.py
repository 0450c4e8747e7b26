"""Commands as transactions: what is wanted of which entities. The knowledge base says it in triples."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Final, NamedTuple

from semmap.schemas import errors, polygons
from semmap.schemas.attachments import GRASP_POSE, IS_GRASPED_BY, pose_text
from semmap.schemas.commands import Add, Attach, Batch, Command, Detach, Set, Track, Unset, Update
from semmap.schemas.commits import Edit, NewEntity, Statement, Transaction
from semmap.schemas.entities import IDENTITY, ClassInfo, Entity, Pose, Size, Value, Vector
from semmap.schemas.scene_files import Described, pose_of

_FEW: Final = 4
"""Of so many changes that are made together the reason names each."""


def transaction(
    command: Command,
    reason: str,
    *,
    remove: Iterable[str] = (),
    edit: Iterable[Edit] = (),
    add: Iterable[NewEntity] = (),
) -> Transaction:
    """A transaction on behalf of `command`. What the scene says no client asked for, so it has no verb."""
    return Transaction(
        id=command.id,
        source=command.source,
        agent=command.agent,
        verb="" if command.source == "scene" else command.VERB,
        reason=command.reason or reason,
        confidence=getattr(command, "confidence", None),
        remove=tuple(remove),
        edit=tuple(edit),
        add=tuple(add),
        unchanged=getattr(command, "unchanged", ()),
        since=getattr(command, "since", 0),
        dry_run=getattr(command, "dry_run", False),
        told=True,
    )


def add(command: Add, name: str, found: ClassInfo, pose: Pose, ref: str | None) -> Transaction:
    """A new entity; its name must be free. Raises BadRequest for an extent of what is no place."""
    at, size, extent = _covering(found, command.extent, pose, command.size)
    new = NewEntity(
        name=name,
        class_iri=found.iri,
        pose=at,
        size=size,
        ref=ref,
        alt=command.alt,
        set=(*extent, *map(_assignment, command.set)),
        tracked=command.track or "",
    )
    return transaction(command, f"add {found.name} {name}", add=[new])


def update(command: Update, entity: Entity, found: ClassInfo | None = None) -> Transaction:
    """What is given of an entity changes; omitted fields keep their values.

    Raises BadRequest for an extent of what is no place; Refused where a box would be of no consequence,
    because the entity's extent is a polygon.
    """
    at, size = command.at, command.size
    extent: tuple[Statement, ...] = ()
    if command.extent is None:
        _require_box(command, entity)
    else:
        is_place, class_name = (entity.place, entity.class_) if found is None else (found.place, found.name)
        _require_place(is_place, class_name)
        if command.yaw is not None or command.orientation is not None:
            raise errors.BadRequest("an extent is in the map frame, and not turned: leave the angle out")
        at, size, extent = _around(command.extent, at, size)
    edit = Edit(
        name=command.name,
        class_iri=None if found is None else found.iri,
        at=at,
        yaw=command.yaw,
        orientation=command.orientation,
        size=size,
        ref=command.ref,
        alt=command.alt,
        conflict=command.conflict,
        unset=tuple(map(_unassignment, command.unset)),
        set=(*extent, *map(_assignment, command.set)),
        carry=command.carry,
        leave=command.leave,
    )
    return transaction(command, f"update {command.name}", edit=[edit])


def state(command: Set) -> Transaction:
    """A property gets values. Raises BadRequest without any."""
    if not command.values:
        raise errors.BadRequest(f"give a value of {command.property}; to have none: semmap unset")
    if command.if_unset and command.if_is is not None:
        raise errors.BadRequest("give either --if-is or --if-unset")
    condition = Statement(property=command.property) if command.if_unset else None
    if command.if_is is not None:
        condition = _statement(command.property, command.if_is)
    edit = Edit(
        name=command.name,
        only_if=() if condition is None else (condition,),
        set=(_statement(command.property, *command.values),),
    )
    said = " ".join(map(_text, command.values))
    return transaction(command, f"set {command.name} {command.property} {said}", edit=[edit])


def unstate(command: Unset) -> Transaction:
    """A property loses a value, or all of them."""
    value = () if command.value is None else (command.value,)
    edit = Edit(
        name=command.name,
        only_if=() if command.if_is is None else (_statement(command.property, command.if_is),),
        unset=(_statement(command.property, *value),),
    )
    said = "".join(f" {_text(v)}" for v in value)
    return transaction(command, f"unset {command.name} {command.property}{said}", edit=[edit])


def together(command: Batch, changes: Sequence[Transaction]) -> Transaction:
    """All of these changes as one."""
    reasons = [change.reason for change in changes]
    said = "; ".join(reasons if len(reasons) <= _FEW else [*reasons[: _FEW - 1], _more(reasons)])
    return transaction(command, said, edit=[edit for change in changes for edit in change.edit])


def _more(reasons: Sequence[str]) -> str:
    return f"and {len(reasons) - _FEW + 1} more changes"


def track(command: Track) -> Transaction:
    """An entity is tracked from now on, or not any more."""
    edit = Edit(name=command.name, tracked="" if command.off else command.from_)
    said = "--off" if command.off else f"--from {command.from_}"
    return transaction(command, f"track {command.name} {said}", edit=[edit])


class Taken(NamedTuple):
    """What is held from now on: by what, where in the frame of that, and where it is just now (map frame)."""

    name: str
    holder: str
    grip: Pose | None
    pose: Pose | None


def attach(command: Attach, to: str, taken: Iterable[Taken]) -> Transaction:
    """Entities are held from now on: the one that was named, by `to`, and what goes with it."""
    edits = [
        Edit(
            name=one.name,
            at=None if one.pose is None else one.pose.position_m,
            orientation=None if one.pose is None else one.pose.orientation_wxyz,
            unset=(Statement(property=GRASP_POSE),) if one.grip is None else (),
            set=gripped(one.holder, one.grip),
        )
        for one in taken
    ]
    return transaction(command, f"attach {command.name} --to {to}", edit=edits)


def detach(command: Detach, poses: Mapping[str, Pose | None]) -> Transaction:
    """Nothing holds these entities any more, which are at `poses` just now (map frame)."""
    edits = [
        Edit(
            name=name,
            at=None if pose is None else pose.position_m,
            orientation=None if pose is None else pose.orientation_wxyz,
            unset=gripped("", None),
        )
        for name, pose in poses.items()
    ]
    return transaction(command, f"detach {command.name}", edit=edits)


def gripped(holder: str, grip: Pose | None) -> tuple[Statement, ...]:
    """What a map states of who holds a thing, and where; without a holder, what it states no more."""
    if not holder:
        return (Statement(property=IS_GRASPED_BY), Statement(property=GRASP_POSE))
    by = Statement(property=IS_GRASPED_BY, values=(holder,))
    return (by,) if grip is None else (by, Statement(property=GRASP_POSE, values=(pose_text(grip),)))


def remove(command: Command, reason: str, names: Iterable[str]) -> Transaction:
    """Entities go, with all that is only theirs and all that others say of them."""
    return transaction(command, reason, remove=names)


def described(name: str, found: ClassInfo, said: Described) -> NewEntity:
    """The entity that a file describes. Raises BadRequest for a pose that is none."""
    given = pose_of(said.at, said.yaw, said.orientation) if said.at is not None else None
    try:
        pose, size, extent = _covering(found, said.extent, given, said.size)
    except errors.BadRequest as error:
        raise errors.BadRequest(f"{name}: {error.text}") from None
    return NewEntity(
        name=name,
        class_iri=found.iri,
        pose=pose,
        size=size,
        ref=said.ref,
        alt=said.alt,
        affordances=said.affords,
        set=(*extent, *map(_assignment, said.set)),
    )


def _covering(
    found: ClassInfo, extent: str | None, pose: Pose | None, size: Size | None
) -> tuple[Pose | None, Size | None, tuple[Statement, ...]]:
    """The pose and size of a new entity, and what is stated of its extent. Raises BadRequest."""
    if extent is None:
        return pose, size, ()
    _require_place(found.place, found.name)
    if pose is not None and pose.orientation_wxyz != IDENTITY:
        raise errors.BadRequest("an extent is in the map frame, and not turned: leave the angle out")
    at, size, stated = _around(extent, None if pose is None else pose.position_m, size)
    return None if at is None else Pose(position_m=at), size, stated


def _around(
    extent: str, at: Vector | None, size: Size | None
) -> tuple[Vector | None, Size | None, tuple[Statement, ...]]:
    """Where a place with this extent is and how large, as far as that is given; and what is stated of it."""
    polygon = polygons.read_wkt(extent)
    centre, box = polygons.box_around(
        polygon, 0.0 if at is None else at[2], polygons.HEIGHT_M if size is None else size[2]
    )
    stated = Statement(property=polygons.EXTENT, values=(polygons.wkt(polygon),))
    return None if at is None else centre, None if size is None else box, (stated,)


def _require_place(is_place: bool, class_name: str) -> None:
    if not is_place:
        raise errors.BadRequest(
            f"only places have an extent, and a {class_name} is none; say how large it is with --size X Y Z"
        )


def _require_box(command: Update, entity: Entity) -> None:
    """Raises Refused for a place that a polygon puts where it is."""
    if any(word.partition("=")[0].strip() == polygons.EXTENT for word in command.unset):
        return
    if polygons.extent_of(entity) is None or entity.pose is None or entity.size_m is None:
        return
    moves = command.at is not None and command.at[:2] != entity.pose.position_m[:2]
    resizes = command.size is not None and command.size[:2] != entity.size_m[:2]
    if moves or resizes or command.yaw is not None or command.orientation is not None:
        raise errors.Refused(
            f"the extent of {entity.name} is a polygon: give another with --extent, or make it a box again"
            f" with --unset {polygons.EXTENT} --at X Y Z --size X Y Z"
        )


def _statement(property_: str, *values: Value) -> Statement:
    return Statement(property=property_, values=tuple(map(_text, values)))


def _text(value: Value) -> str:
    """A value as people write it."""
    return str(value).lower() if isinstance(value, bool) else str(value)


def _assignment(words: str) -> Statement:
    """`PROPERTY=VALUE`. Raises BadRequest."""
    name, equals, value = words.partition("=")
    if not (name and equals):
        raise errors.BadRequest(f"'{words}' is not of the form PROPERTY=VALUE")
    return Statement(property=name.strip(), values=(value,))


def _unassignment(words: str) -> Statement:
    """`PROPERTY` or `PROPERTY=VALUE`."""
    name, equals, value = words.partition("=")
    return Statement(property=name.strip(), values=(value,) if equals else ())
