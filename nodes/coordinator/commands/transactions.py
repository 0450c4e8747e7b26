"""Builds transactions from commands; the knowledge base converts them to triples."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Final, NamedTuple

from msgspec import structs

from semmap.ontology import vocabulary as v
from semmap.schemas import errors, polygons
from semmap.schemas.attachments import GRASP_POSE, IS_GRASPED_BY, pose_text
from semmap.schemas.commands import Add, Attach, Batch, Command, Detach, Set, Track, Unset, Update
from semmap.schemas.commits import Edit, NewEntity, Statement, Transaction
from semmap.schemas.entities import IDENTITY, ClassInfo, Entity, Pose, Size, Value, Vector
from semmap.schemas.scene_files import Described, pose_of

_FEW: Final = 4
"""Up to this number of changes, the reason of a batch names each."""


def build(
    command: Command,
    reason: str,
    *,
    remove: Iterable[str] = (),
    edit: Iterable[Edit] = (),
    add: Iterable[NewEntity] = (),
) -> Transaction:
    """Build a transaction for `command`. Changes that come from the scene have no verb."""
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
    """Build a transaction that adds an entity, whose name must be free.

    Raises BadRequest if an extent is given for an object.
    """
    at, size, extent = _pose_and_size(found, command.extent, pose, command.size)
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
    return build(command, f"add {found.name} {name}", add=[new])


def update(command: Update, entity: Entity, found: ClassInfo | None = None) -> Transaction:
    """Build a transaction that updates an entity; omitted fields keep their values.

    Raises BadRequest if an extent is given for an object. Raises Refused for a new box if the extent is a
    polygon.
    """
    at, size = command.at, command.size
    extent: tuple[Statement, ...] = ()
    if command.extent is None:
        _require_box(command, entity)
    else:
        is_place, class_name = (entity.place, entity.class_) if found is None else (found.place, found.name)
        _require_place(is_place, class_name)
        if command.yaw is not None or command.orientation is not None:
            raise errors.BadRequest("an extent is in the map frame and cannot be turned; remove the angle")
        at, size, extent = _box_around(command.extent, at, size)
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
    return build(command, f"update {command.name}", edit=[edit])


def set_property(command: Set) -> Transaction:
    """Build a transaction that sets values of a property. Raises BadRequest without any."""
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
    text = " ".join(map(_text, command.values))
    return build(command, f"set {command.name} {command.property} {text}", edit=[edit])


def unset_property(command: Unset) -> Transaction:
    """Build a transaction that removes a value of a property, or all of them."""
    value = () if command.value is None else (command.value,)
    edit = Edit(
        name=command.name,
        only_if=() if command.if_is is None else (_statement(command.property, command.if_is),),
        unset=(_statement(command.property, *value),),
    )
    text = "".join(f" {_text(v)}" for v in value)
    return build(command, f"unset {command.name} {command.property}{text}", edit=[edit])


def for_name(transaction: Transaction, name: str) -> Transaction:
    """Return a transaction with one edit as one of the entity `name`."""
    (edit,) = transaction.edit
    return structs.replace(transaction, edit=(structs.replace(edit, name=name),))


def combine(command: Batch, changes: Sequence[Transaction]) -> Transaction:
    """Combine the transactions of a batch into one."""
    reasons = [change.reason for change in changes]
    text = "; ".join(reasons if len(reasons) <= _FEW else [*reasons[: _FEW - 1], _more(reasons)])
    return build(command, text, edit=[edit for change in changes for edit in change.edit])


def _more(reasons: Sequence[str]) -> str:
    return f"and {len(reasons) - _FEW + 1} more changes"


def track(command: Track) -> Transaction:
    """Build a transaction that starts or stops tracking an entity."""
    edit = Edit(name=command.name, tracked="" if command.off else command.from_)
    text = "--off" if command.off else f"--from {command.from_}"
    return build(command, f"track {command.name} {text}", edit=[edit])


class Attachment(NamedTuple):
    """A new attachment: its holder, the pose in the holder's frame, and the current pose (map frame)."""

    name: str
    holder: str
    grip: Pose | None
    pose: Pose | None


def attach(command: Attach, to: str, taken: Iterable[Attachment]) -> Transaction:
    """Build a transaction that attaches the named entity to `to`, and its contents to it."""
    edits = [
        Edit(
            name=one.name,
            at=None if one.pose is None else one.pose.position_m,
            orientation=None if one.pose is None else one.pose.orientation_wxyz,
            unset=(Statement(property=GRASP_POSE),) if one.grip is None else (),
            set=grip_statements(one.holder, one.grip),
        )
        for one in taken
    ]
    return build(command, f"attach {command.name} --to {to}", edit=edits)


def detach(command: Detach, poses: Mapping[str, Pose | None]) -> Transaction:
    """Build a transaction that detaches entities, which are at `poses` (map frame)."""
    edits = [
        Edit(
            name=name,
            at=None if pose is None else pose.position_m,
            orientation=None if pose is None else pose.orientation_wxyz,
            unset=grip_statements("", None),
        )
        for name, pose in poses.items()
    ]
    return build(command, f"detach {command.name}", edit=edits)


def grip_statements(holder: str, grip: Pose | None) -> tuple[Statement, ...]:
    """Return the statements about a holder and the pose in its frame; without a holder, those to remove."""
    if not holder:
        return (Statement(property=IS_GRASPED_BY), Statement(property=GRASP_POSE))
    by = Statement(property=IS_GRASPED_BY, values=(holder,))
    return (by,) if grip is None else (by, Statement(property=GRASP_POSE, values=(pose_text(grip),)))


def remove(command: Command, reason: str, names: Iterable[str]) -> Transaction:
    """Build a transaction that removes entities with all facts about them."""
    return build(command, reason, remove=names)


def clear(command: Command, names: Iterable[str]) -> Transaction:
    """Build a transaction that empties the map."""
    return structs.replace(build(command, "clear", remove=names), others=True)


def new_entity(name: str, found: ClassInfo, text: Described) -> NewEntity:
    """Return the new entity that a file describes. Raises BadRequest for an invalid pose."""
    given = pose_of(text.at, text.yaw, text.orientation) if text.at is not None else None
    try:
        pose, size, extent = _pose_and_size(found, text.extent, given, text.size)
    except errors.BadRequest as error:
        raise errors.BadRequest(f"{name}: {error.text}") from None
    return NewEntity(
        name=name,
        class_iri=found.iri,
        pose=pose,
        size=size,
        ref=text.ref,
        alt=text.alt,
        affordances=text.affords,
        set=(*extent, *map(_assignment, text.set)),
    )


def edit_entity(entity: Entity, found: ClassInfo, text: Described) -> Edit:
    """Return the change of an entity to what a file describes; what the file omits stays.

    Raises BadRequest for an invalid pose, and Refused for a new box if the extent is a polygon.
    """
    new = new_entity(entity.name, found, text)
    if text.extent is None and (new.pose is not None or new.size is not None):
        _require_box(Update(name=entity.name, at=text.at, size=text.size), entity)
    affordances = (Statement(property=v.HAS_AFFORDANCE, values=tuple(map(v.dm, new.affordances))),)
    return Edit(
        name=entity.name,
        class_iri=new.class_iri,
        at=None if new.pose is None else new.pose.position_m,
        orientation=None if new.pose is None else new.pose.orientation_wxyz,
        yaw=text.yaw if new.pose is None else None,
        size=new.size,
        ref=new.ref,
        alt=new.alt or None,
        set=(*new.set, *(affordances if new.affordances else ())),
    )


def _pose_and_size(
    found: ClassInfo, extent: str | None, pose: Pose | None, size: Size | None
) -> tuple[Pose | None, Size | None, tuple[Statement, ...]]:
    """Return the pose, the size and the extent statements of a new entity. Raises BadRequest."""
    if extent is None:
        return pose, size, ()
    _require_place(found.place, found.name)
    if pose is not None and pose.orientation_wxyz != IDENTITY:
        raise errors.BadRequest("an extent is in the map frame and cannot be turned; remove the angle")
    at, size, stated = _box_around(extent, None if pose is None else pose.position_m, size)
    return None if at is None else Pose(position_m=at), size, stated


def _box_around(
    extent: str, at: Vector | None, size: Size | None
) -> tuple[Vector | None, Size | None, tuple[Statement, ...]]:
    """Return the position, the size and the statements of a place with this extent, as far as given."""
    polygon = polygons.read_wkt(extent)
    centre, box = polygons.box_around(
        polygon, 0.0 if at is None else at[2], polygons.HEIGHT_M if size is None else size[2]
    )
    stated = Statement(property=polygons.EXTENT, values=(polygons.wkt(polygon),))
    return None if at is None else centre, None if size is None else box, (stated,)


def _require_place(is_place: bool, class_name: str) -> None:
    if not is_place:
        raise errors.BadRequest(
            f"only places have an extent, and a {class_name} is not a place; use --size X Y Z"
        )


def _require_box(command: Update, entity: Entity) -> None:
    """Raise Refused for a new box of a place whose extent is a polygon."""
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
    """Return a value as text."""
    return str(value).lower() if isinstance(value, bool) else str(value)


def _assignment(words: str) -> Statement:
    """Parse `PROPERTY=VALUE`. Raises BadRequest."""
    name, equals, value = words.partition("=")
    if not (name and equals):
        raise errors.BadRequest(f"'{words}' is not of the form PROPERTY=VALUE")
    return Statement(property=name.strip(), values=(value,))


def _unassignment(words: str) -> Statement:
    """Parse `PROPERTY` or `PROPERTY=VALUE`."""
    name, equals, value = words.partition("=")
    return Statement(property=name.strip(), values=(value,) if equals else ())
