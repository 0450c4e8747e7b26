"""The roles of certificates, and the sets of roles that commands and keys are granted to."""

from __future__ import annotations

from typing import Final, Literal, get_args

Role = Literal["viewer", "operator", "perception", "robot", "admin", "node"]
ROLES: Final[tuple[Role, ...]] = get_args(Role)
Roles = frozenset[Role]

ANYBODY: Final[Roles] = frozenset(ROLES)
OPERATORS: Final[Roles] = frozenset(("operator", "admin", "node"))
OBSERVERS: Final[Roles] = OPERATORS | {"perception"}
ADMINS: Final[Roles] = frozenset(("admin", "node"))
NODES: Final[Roles] = frozenset(("node",))
