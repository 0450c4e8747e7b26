"""Settings of the knowledge base."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from semmap.nodes.bus import Network


@dataclass(frozen=True)
class Replay:
    """Replay up to commit `until` of another journal, `speed` times as fast as it was recorded.

    No wait between two commits is longer than `longest_s`. The replay begins when all of `nodes` are ready.
    """

    until: int
    speed: float
    longest_s: float
    nodes: tuple[str, ...]


@dataclass(frozen=True)
class KbConfig:
    """Configuration of the node. `data` is the folder of the journal, seeded or prepared for a replay.

    With `enforce_shapes`, commits that violate a SHACL shape of the TBox are rejected.
    """

    data: Path
    network: Network = field(default_factory=Network)
    replay: Replay | None = None
    enforce_shapes: bool = False
