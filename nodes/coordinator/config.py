"""Settings of the coordinator."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

from semmap.nodes.bus import Network

Truth = Literal["map", "scene", "perceived", "replayed"]


@dataclass(frozen=True)
class Thresholds:
    """Distances from the committed state above which a body counts as moved."""

    distance_m: float = 0.05
    angle_rad: float = math.radians(5.0)
    share: float = 0.02
    """As a fraction of the range of a joint."""


@dataclass(frozen=True)
class LiveRules:
    """When a live pose is stale, and how often poses of moving entities are committed (0: only at rest)."""

    stale_s: float = 2.0
    journal_every_s: float = 0.0


@dataclass(frozen=True)
class CoordinatorConfig:
    """`truth` is the source of truth for which entities exist.

    With `map` the scene follows the map, and with `scene` the map follows the scene. With `perceived` the
    simulator represents the real world, and only perception updates the map. With `replayed` the map is in
    the past, and the scene follows it without changing it.
    """

    truth: Truth = "map"
    thresholds: Thresholds = field(default_factory=Thresholds)
    live: LiveRules = field(default_factory=LiveRules)
    network: Network = field(default_factory=Network)
    keys: Path | None = None
    """The folder of keys of a secure system, in which names are certified and roles are enforced."""
