"""Where a system is reached when nothing else is said."""

from __future__ import annotations

import re
from typing import Final

from semmap.schemas.errors import BadRequest

DEFAULT_ENDPOINT: Final = "tcp/127.0.0.1:7447"
CONNECT_VARIABLE: Final = "SEMMAP_CONNECT"
"""The environment variable with another endpoint."""
CONFIG_VARIABLE: Final = "SEMMAP_ZENOH_CONFIG"
"""The environment variable with a Zenoh configuration file, for a system that was started with its own."""
IDENTITY_VARIABLE: Final = "SEMMAP_IDENTITY"
"""The environment variable with who somebody is."""
WEB_TOKEN_VARIABLE: Final = "SEMMAP_WEB_TOKEN"
"""The environment variable with the token that opens the page; without it one is made up."""
NAMESPACE_VARIABLE: Final = "SEMMAP_NAMESPACE"
"""The environment variable with which robot is meant, where several share a network."""

_ROBOT: Final = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.-]{0,127}")


ALL_ROBOTS: Final = "*"
"""As a namespace: of a router that several robots share, and of nothing else."""


def robot_name(name: str) -> str:
    """`name`, if a robot may be called so; empty is a robot without a name. Raises BadRequest."""
    if name and not _ROBOT.fullmatch(name):
        raise BadRequest(f"'{name}' cannot name a robot; use letters, digits, '_', '.' and '-', as in robot1")
    return name
