"""Settings of the simulator."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from nodes.bus import Network


@dataclass(frozen=True)
class SimConfig:
    """`world` is an MJCF scene, None a bare floor."""

    world: Path | None = None
    network: Network = field(default_factory=Network)
