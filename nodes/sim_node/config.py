"""Settings of the simulator."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from semmap.nodes.bus import RESTART_S, Network


@dataclass(frozen=True)
class CameraConfig:
    """How the cameras of the world publish; a rate of 0 disables them."""

    rate_hz: float = 0.0
    width: int = 640
    height: int = 480
    noise: bool = False
    segments: bool = False
    graphics: bool = True
    """Whether to use OpenGL if available; otherwise rays are cast."""


@dataclass(frozen=True)
class RobotConfig:
    """A robot's MJCF file, its entity name, and its initial pose.

    `at_m` is a point on the floor [m, map frame].
    """

    path: Path
    name: str = "robot1"
    at_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    yaw_rad: float = 0.0


@dataclass(frozen=True)
class SimConfig:
    """The settings of the simulator.

    `world` is an MJCF or JSON scene, or None for a bare floor. `models` is a folder of model files
    (`models.sources`).
    """

    world: Path | None = None
    models: Path | None = None
    window: bool = False
    cameras: CameraConfig = field(default_factory=CameraConfig)
    network: Network = field(default_factory=Network)
    data: Path | None = None
    """The system's data folder, which may also contain model files."""
    patience_s: float = RESTART_S
    """Time to wait for the knowledge base, if the world file names classes [s]."""
    still: bool = False
    """Whether to start with paused time: bodies stay at their ordered poses."""
    robot: RobotConfig | None = None
    class_map: Mapping[str, str] = field(default_factory=dict)
    """The classes of bodies of the world file, by name with or without its number."""
    is_truth: bool = False
    """Whether the scene is the source of truth, so that every body becomes an entity."""
