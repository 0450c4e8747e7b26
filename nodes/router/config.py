"""Settings of the router."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from nodes.bus import Network


@dataclass(frozen=True)
class RouterConfig:
    """`keys` is the folder of keys, with the register of who is admitted; `network` says where to listen."""

    keys: Path
    network: Network
