"""Settings of the simulator."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from semmap.nodes.bus import RESTART_S, Network


@dataclass(frozen=True)
class CameraConfig:
    """How the cameras of the world publish; a rate of 0 means they do not."""

    rate_hz: float = 0.0
    width: int = 640
    height: int = 480
    noise: bool = False
    segments: bool = False
    graphics: bool = True
    """OpenGL where it is to be had; False casts rays."""


@dataclass(frozen=True)
class RobotConfig:
    """A robot's MJCF file, its name as an entity, and where it stands until the map says otherwise.

    `at_m` is a point on the floor [m, map frame].
    """

    path: Path
    name: str = "robot1"
    at_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    yaw_rad: float = 0.0


@dataclass(frozen=True)
class SimConfig:
    """`world` is an MJCF or JSON scene, None a bare floor; `models` a folder of files (`models.sources`)."""

    world: Path | None = None
    models: Path | None = None
    window: bool = False
    cameras: CameraConfig = field(default_factory=CameraConfig)
    network: Network = field(default_factory=Network)
    data: Path | None = None
    """The system's data folder, where model files may be, too."""
    patience_s: float = RESTART_S
    """Seconds to wait for the knowledge base, where the world is one that names classes."""
    still: bool = False
    """Time is paused from the start: bodies stand where they are ordered to."""
    robot: RobotConfig | None = None
