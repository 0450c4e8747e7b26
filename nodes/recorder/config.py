"""Settings of the recorder."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from semmap.nodes.bus import Network
from semmap.nodes.recorder.retention import KEEP_ALL, Retention

LIVE_VIEW = "127.0.0.1:9876"
"""Where Rerun viewers look for a live recording when nothing else is said."""


@dataclass(frozen=True)
class RecorderConfig:
    """`path` is the .rrd file to write; `serve` the address for live viewers, None for none.

    `keep` is how much is kept of the recordings in that folder. `after` is the last commit that an earlier
    recording has, where this one goes on from there.
    """

    path: Path
    network: Network = field(default_factory=Network)
    serve: str | None = LIVE_VIEW
    keep: Retention = KEEP_ALL
    after: int | None = None
