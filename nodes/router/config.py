"""Settings of the router."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from semmap.nodes.bus import Network


@dataclass(frozen=True)
class RouterConfig:
    """`keys` is the folder of keys, with the register of who is admitted; None admits everybody.

    `network` says where to listen, and to which routers of other hosts to connect.
    """

    keys: Path | None
    network: Network
    namespace: str = ""
    """Which keys those who are admitted may use: a robot's, or `*`, those of all robots."""
