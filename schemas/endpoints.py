"""The default endpoint and the environment variables of a connection."""

from __future__ import annotations

import re
from typing import Final

from semmap.schemas.errors import BadRequest

DEFAULT_ENDPOINT: Final = "tcp/127.0.0.1:7447"
CONNECT_VARIABLE: Final = "SEMMAP_CONNECT"
"""The environment variable with the endpoint."""
CONFIG_VARIABLE: Final = "SEMMAP_ZENOH_CONFIG"
"""The environment variable with a Zenoh configuration file, for a system that was started with one."""
IDENTITY_VARIABLE: Final = "SEMMAP_IDENTITY"
"""The environment variable with the client's identity."""
WEB_TOKEN_VARIABLE: Final = "SEMMAP_WEB_TOKEN"
"""The environment variable with the access token of the page; without it, one is generated."""
NAMESPACE_VARIABLE: Final = "SEMMAP_NAMESPACE"
"""The environment variable with the robot's name, if several robots share a network."""

_ROBOT: Final = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.-]{0,127}")


ALL_ROBOTS: Final = "*"
"""The namespace of a router that several robots share."""


def robot_name(name: str) -> str:
    """Return `name` if it is a valid robot name; empty stands for no name. Raises BadRequest."""
    if name and not _ROBOT.fullmatch(name):
        raise BadRequest(f"'{name}' is not a valid robot name; use letters, digits, '_', '.' and '-'")
    return name
