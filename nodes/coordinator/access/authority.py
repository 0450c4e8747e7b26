"""Authority: which sources may change facts that another source has asserted.

Every source may change the pose of an entity. The class, the labels and the existence of an entity are
changed only by an operator (or a file of an operator) once an operator has asserted them.
"""

from __future__ import annotations

from collections.abc import Iterable

from semmap.nodes.coordinator.config import Truth
from semmap.schemas import errors
from semmap.schemas.commands import Batch, Clear, Command, Remove, Undo, Update
from semmap.schemas.entities import LESSER, Entity

_COMES_BACK = {
    "scene": "the scene is the source of truth (--truth scene): a body that is still there is added again",
    "perceived": "perception is the source of truth (--truth perceived): what it still sees is added again",
}
_STAYS = {"scene": "the scene is the source of truth (--truth scene): bodies stay; to move one: semmap move"}
_GOES_BACK = {
    "scene": "the scene is the source of truth for poses (--truth scene); to move a body: semmap move"
}


def require_authority(command: Command, concerned: Iterable[Entity]) -> None:
    """Raise Refused if the source of the command may not change or remove these entities."""
    if command.source not in LESSER:
        return
    for entity in concerned:
        if not {entity.shape_provenance.source, entity.reference_provenance.source} <= LESSER:
            raise errors.Refused(
                f"{entity.name} was defined by an operator, so only an operator may change or remove it;"
                " any client may move it"
            )


def describe_override(command: Command, truth: Truth) -> str | None:
    """Return a note if the scene or perception will override the change; None otherwise."""
    if isinstance(command, (Remove, Clear)):
        return _COMES_BACK.get(truth)
    if isinstance(command, Undo):
        return _STAYS.get(truth)
    changes = command.changes if isinstance(command, Batch) else (command,)
    return _GOES_BACK.get(truth) if any(map(is_placing, changes)) else None


def is_placing(change: Command) -> bool:
    """Return whether a change sets the pose of an existing entity."""
    if not isinstance(change, Update):
        return False
    fields = (change.at, change.yaw, change.orientation, change.on, change.in_, change.next_to)
    return any(field is not None for field in fields)


def require_operator(command: Command, what: str) -> None:
    """Raise Refused for a source that is not an operator."""
    if command.source in LESSER:
        raise errors.Refused(f"only an operator may {what}")
