"""Settings of the knowledge base."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from nodes.bus import Network


@dataclass(frozen=True)
class KbConfig:
    """`data` is the folder of the journal; it must have been seeded (see seed.py)."""

    data: Path
    network: Network = field(default_factory=Network)
