"""Commands as transactions: what is wanted of which entities. The knowledge base says it in triples."""

from __future__ import annotations

from collections.abc import Iterable

from schemas import errors
from schemas.commands import Add, Command, Set, Track, Unset, Update
from schemas.commits import Edit, NewEntity, Statement, Transaction
from schemas.entities import ClassInfo, Pose, Value
from schemas.scene_files import Described, pose_of


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
    """A new entity; its name must be free."""
    new = NewEntity(
        name=name,
        class_iri=found.iri,
        pose=pose,
        size=command.size,
        ref=ref,
        alt=command.alt,
        set=tuple(map(_assignment, command.set)),
        tracked=command.track or "",
    )
    return transaction(command, f"add {found.name} {name}", add=[new])


def update(command: Update, found: ClassInfo | None = None) -> Transaction:
    """What is given changes; omitted fields keep their values."""
    edit = Edit(
        name=command.name,
        class_iri=None if found is None else found.iri,
        at=command.at,
        yaw=command.yaw,
        orientation=command.orientation,
        size=command.size,
        ref=command.ref,
        alt=command.alt,
        conflict=command.conflict,
        unset=tuple(map(_unassignment, command.unset)),
        set=tuple(map(_assignment, command.set)),
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


def track(command: Track) -> Transaction:
    """An entity is tracked from now on, or not any more."""
    edit = Edit(name=command.name, tracked="" if command.off else command.from_)
    said = "--off" if command.off else f"--from {command.from_}"
    return transaction(command, f"track {command.name} {said}", edit=[edit])


def remove(command: Command, reason: str, names: Iterable[str]) -> Transaction:
    """Entities go, with all that is only theirs and all that others say of them."""
    return transaction(command, reason, remove=names)


def described(name: str, found: ClassInfo, said: Described) -> NewEntity:
    """The entity that a file describes. Raises BadRequest for a pose that is none."""
    return NewEntity(
        name=name,
        class_iri=found.iri,
        pose=pose_of(said.at, said.yaw, said.orientation) if said.at is not None else None,
        size=said.size,
        ref=said.ref,
        alt=said.alt,
        affordances=said.affords,
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
