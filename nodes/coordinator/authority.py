"""Precedence: who may change what was said by whom.

Anybody may say where a thing is now. What it is, what it is called and whether it is there at all is changed
only by an operator (or a file of an operator's) once an operator has said it.
"""

from __future__ import annotations

from collections.abc import Iterable

from schemas import errors
from schemas.commands import Command
from schemas.entities import Entity

_LESSER = frozenset(("scene", "perception"))


def require_authority(command: Command, concerned: Iterable[Entity]) -> None:
    """Raises Refused when the command's source may not change what these entities are."""
    if command.source not in _LESSER:
        return
    for entity in concerned:
        if not {entity.shape_provenance.source, entity.reference_provenance.source} <= _LESSER:
            raise errors.Refused(
                f"an operator said what {entity.name} is, so only an operator may change that or remove it;"
                " anybody may say where it is"
            )


def require_operator(command: Command, what: str) -> None:
    """Raises Refused for any other source."""
    if command.source in _LESSER:
        raise errors.Refused(f"only an operator may {what}")
