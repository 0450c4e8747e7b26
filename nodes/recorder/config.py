"""Settings of the recorder."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from semmap.nodes.bus import Network
from semmap.nodes.recorder.retention import KEEP_ALL, Retention

LIVE_VIEW = "127.0.0.1:9876"
"""The address that Rerun viewers connect to by default."""


@dataclass(frozen=True)
class RecorderConfig:
    """The settings of the recorder.

    `path` is the .rrd file, and `serve` the address for live viewers or None. `keep` limits the recordings
    kept in the folder of `path`. `after` is the last commit of an earlier recording that this one continues;
    without one, the recording begins with the commits since `begun_ns`, the start of the system, or with the
    last one before it.
    """

    path: Path
    network: Network = field(default_factory=Network)
    serve: str | None = LIVE_VIEW
    keep: Retention = KEEP_ALL
    after: int | None = None
    begun_ns: int = 0
