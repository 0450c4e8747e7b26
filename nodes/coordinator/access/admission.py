"""Admission: who asks for a command, proved by a certificate or merely claimed, and whether their role may.

Zenoh does not tell a queryable whose certificate a query came with, so a secure system has the name in the
key: `semmap/as/bob/cmd/add` reaches the coordinator from bob only, because the router lets it through from
nobody else. What the name may do is decided here, where commands can be read.
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
    """A command of somebody who says who they are. Raises BadRequest for the mark of a proved name."""
    if agents.is_proved(command.agent):
        raise errors.BadRequest(
            f"the agent '{command.agent}' begins with '@', which marks names that a certificate has proved;"
            " leave it out"
        )
    return command


class Admission:
    """That of a secure system. Owned by the coordinator's thread."""

    def __init__(self, folder: Path) -> None:
        """`folder` is that of the keys. Raises BadFile."""
        self._register = LiveRegister(folder)

    def admit_certified(self, who: str, command: C) -> C:
        """The command in the name of `who`. Raises Refused when their role may not ask for it."""
        if "*" in who:
            raise errors.Refused(f"'{who}' is not one name; ask for commands under your own")
        role = self._register.role_of(who)
        if role is None:
            raise errors.NoAnswer(f"the certificate of {who} has been revoked")
        if (refusal := roles.refusal(role, command)) is not None:
            raise errors.Refused(refusal)
        return structs.replace(command, agent=agents.proved(who))
