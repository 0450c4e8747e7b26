"""Admission: identifies the client of a command by its certificate or its claim, and checks its role.

Zenoh does not tell a queryable which certificate a query came with. In a secure system the client's name is
therefore part of the key: the router accepts `semmap/as/bob/cmd/add` only from bob. Whether the role of that
name permits the command is checked here, where commands can be decoded.
"""

from __future__ import annotations

from pathlib import Path
from typing import TypeVar

from msgspec import structs

from semmap.nodes.identity.register import LiveRegister
from semmap.schemas import agents, errors, roles
from semmap.schemas.commands import Command

C = TypeVar("C", bound=Command)


def admit_claimed(who: str, command: C) -> C:
    """Accept a command whose client is not certified. Raises BadRequest for the mark of certified names."""
    if agents.is_proved(command.agent):
        raise errors.BadRequest(
            f"the agent '{command.agent}' begins with '@', which marks certified names; remove the '@'"
        )
    return command


class Admission:
    """Admission of a secure system. Owned by the coordinator's thread."""

    def __init__(self, folder: Path) -> None:
        """`folder` is the folder of keys. Raises BadFile."""
        self._register = LiveRegister(folder)

    def admit_certified(self, who: str, command: C) -> C:
        """Return the command in the name of `who`. Raises Refused if the role does not permit it."""
        if "*" in who:
            raise errors.Refused(f"'{who}' is a pattern; use the key with your own name")
        role = self._register.role_of(who)
        if role is None:
            raise errors.NoAnswer(f"the certificate of {who} has been revoked")
        if (refusal := roles.refusal(role, command)) is not None:
            raise errors.Refused(refusal)
        return structs.replace(command, agent=agents.proved(who))
