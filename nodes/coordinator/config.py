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
    """How far a body must be from where the map says, to count as moved."""

    distance_m: float = 0.05
    angle_rad: float = math.radians(5.0)
    share: float = 0.02
    """Of the way of a door or drawer: how far open it must be more or less."""


@dataclass(frozen=True)
class LiveRules:
    """When a live pose is stale, and how often it is committed of what moves; 0 is not before it stops."""

    stale_s: float = 2.0
    journal_every_s: float = 0.0


@dataclass(frozen=True)
class CoordinatorConfig:
    """`truth` says who owns existence: in `map` the scene follows the map, in `scene` the other way.

    In `perceived` the simulator stands for the world itself: only perception updates the map. In
    `replayed` the map is the past, which the scene follows and never changes.
    """

    truth: Truth = "map"
    thresholds: Thresholds = field(default_factory=Thresholds)
    live: LiveRules = field(default_factory=LiveRules)
    network: Network = field(default_factory=Network)
    keys: Path | None = None
    """The folder of keys of a secure system: then names are proved, and roles hold."""
