"""Settings of the recorder."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from nodes.bus import Network

LIVE_VIEW = "127.0.0.1:9876"
"""Where Rerun viewers look for a live recording when nothing else is said."""


@dataclass(frozen=True)
class RecorderConfig:
    """`path` is the .rrd file to write; `serve` the address for live viewers, None for none."""

    path: Path
    network: Network = field(default_factory=Network)
    serve: str | None = LIVE_VIEW
