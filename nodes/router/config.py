"""Settings of the router."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from semmap.nodes.bus import Network


@dataclass(frozen=True)
class RouterConfig:
    """`keys` is the folder of keys with the register of identities; None admits all clients.

    `network` defines where to listen, and which routers of other hosts to connect to.
    """

    keys: Path | None
    network: Network
    namespace: str = ""
    """The namespace of admitted clients: the name of a robot, or `*` for all robots."""
