"""Precedence: who may change what whom has asserted.

Anybody may say where a thing is now. What it is, what it is called and whether it is there at all is changed
only by an operator (or a file of an operator's) once an operator has said it.
"""

from __future__ import annotations

from collections.abc import Iterable

from semmap.nodes.coordinator.config import Truth
from semmap.schemas import errors
from semmap.schemas.commands import Add, Batch, Clear, Command, Remove, Update
from semmap.schemas.entities import LESSER, Entity

_COMES_BACK = {
    "scene": "the scene decides what exists (--truth scene): a body that still stands there is added again",
    "perceived": "perception decides what exists (--truth perceived): what it still sees is added again",
}
_GOES_BACK = {"scene": "the scene decides where bodies stand (--truth scene); to move one: semmap move"}


def require_authority(command: Command, concerned: Iterable[Entity]) -> None:
    """Raises Refused when the command's source may not change what these entities are."""
    if command.source not in LESSER:
        return
    for entity in concerned:
        if not {entity.shape_provenance.source, entity.reference_provenance.source} <= LESSER:
            raise errors.Refused(
                f"an operator stated what {entity.name} is, so only an operator may change that or remove it;"
                " any client may move it"
            )


def describe_override(command: Add | Update | Batch | Remove | Clear, truth: Truth) -> str | None:
    """What will become of a change where the map does not own what it changes; None where it does."""
    if isinstance(command, (Remove, Clear)):
        return _COMES_BACK.get(truth)
    changes = command.changes if isinstance(command, Batch) else (command,)
    return _GOES_BACK.get(truth) if any(map(is_placing, changes)) else None


def is_placing(change: Command) -> bool:
    """Does it say where an entity that is there stands from now on?"""
    return isinstance(change, Update) and (change.at, change.yaw, change.orientation) != (None, None, None)


def require_operator(command: Command, what: str) -> None:
    """Raises Refused for any other source."""
    if command.source in LESSER:
        raise errors.Refused(f"only an operator may {what}")
