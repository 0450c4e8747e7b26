"""Endpoints, and the environment variables of a connection."""

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


_WITH_PORT: Final = ("tcp", "tls", "udp", "quic", "ws")
_OTHERS: Final = ("unixsock-stream", "unixpipe", "serial", "vsock")
_ADDRESS: Final = re.compile(r"(\[[0-9a-fA-F:.%\w]+\]|[^\s/\[\]:?#,]+):(\d{1,5})([?#].*)?")


def parse_endpoint(text: str) -> str:
    """Return a Zenoh endpoint such as `tcp/127.0.0.1:7447`.

    `HOST:PORT` and `tcp://HOST:PORT` are accepted, too. Raises BadRequest for anything else.
    """
    given = str(text).strip()  # Python programs may pass a port, whose number is not an endpoint either
    protocol, separator, address = given.partition("/")
    if not separator:
        protocol, address = "tcp", given
    elif protocol.endswith(":"):
        protocol, address = protocol[:-1], address.removeprefix("/").removesuffix("/")
    if protocol in _OTHERS and address:
        return f"{protocol}/{address}"
    match = _ADDRESS.fullmatch(address)
    if protocol not in _WITH_PORT or match is None or int(match[2]) >= 1 << 16:
        raise BadRequest(f"'{text}' is not a valid endpoint; use tcp/HOST:PORT, as in {DEFAULT_ENDPOINT}")
    return f"{protocol}/{address}"


ALL_ROBOTS: Final = "*"
"""The namespace of a router that several robots share."""


def robot_name(name: str) -> str:
    """Return `name` if it is a valid robot name; empty stands for no name. Raises BadRequest."""
    if name and not (isinstance(name, str) and _ROBOT.fullmatch(name)):
        raise BadRequest(f"'{name}' is not a valid robot name; use letters, digits, '_', '.' and '-'")
    return name
