"""Settings of perception."""

from __future__ import annotations

from dataclasses import dataclass, field

from nodes.bus import Network


@dataclass(frozen=True)
class PerceptionConfig:
    """How the node reaches the others."""

    network: Network = field(default_factory=Network)
