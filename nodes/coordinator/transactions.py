"""Commands as transactions: what is wanted of which entities. The knowledge base says it in triples."""

from __future__ import annotations

from collections.abc import Iterable

from schemas.commands import Add, Command, Update
from schemas.commits import Edit, NewEntity, Transaction
from schemas.entities import ClassInfo, Pose
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
    )


def add(command: Add, name: str, found: ClassInfo, pose: Pose, ref: str | None) -> Transaction:
    """A new entity; its name must be free."""
    new = NewEntity(name=name, class_iri=found.iri, pose=pose, size=command.size, ref=ref, alt=command.alt)
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
    )
    return transaction(command, f"update {command.name}", edit=[edit])


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
