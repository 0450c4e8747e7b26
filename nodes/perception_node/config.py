"""Settings of the perception node."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal

from semmap.nodes.bus import Network
from semmap.schemas.perception import LEAST_SCORE


@dataclass(frozen=True)
class TrackingConfig:
    """When the map is updated from observations. A frame is what all cameras see at one moment."""

    confirm_frames: int = 3
    """Frames in which a thing must be seen at rest before it becomes an entity; a miss costs two of them."""
    vague_frames: int = 6
    """Frames in which a thing of no known class must be seen: it may be noise, or a part of another."""
    clear_frames: int = 2
    """The same for a thing that no image edge cuts, and whose class has the probability `clear`."""
    clear: float = 0.8
    part_frames: int = 3
    """The same for a thing that is cut by an image edge."""
    vanished_frames: int = 1
    """Consecutive frames in which a place must be empty before the thing is searched elsewhere."""
    rest_frames: int = 2
    """Frames in which a known entity must be seen elsewhere, at rest, before it counts as moved."""
    nudge_frames: int = 8
    """The same if it overlaps its old place, which is not seen empty: the motion may be an error."""
    kept_frames: int = 40
    """The same if the remainder of its old place is filled: only a part may have been seen."""
    pushed_m: float = math.inf
    """Maximum distance at which a large vanished thing is found again in another of the same kind."""
    hidden_m: float = 0.3
    """Distance at which a thing that just got hidden is found again in a new one that is like it."""
    odd_frames: int = 15
    """Consecutive frames in which a thing of another size fills its place before an entity is gone."""
    gone_frames: int = 10
    """Consecutive frames in which an entity should be visible and is not, before it is gone."""
    still_m: float = 0.02
    """A thing that moves less than this between frames is at rest."""
    moved_m: float = 0.03
    turned_rad: float = math.radians(20.0)
    """An entity has moved if its pose differs by more than `moved_m` or `turned_rad`."""
    resized: float = 0.25
    """A size has changed if an extent differs by more than this share."""
    still_camera: bool = True
    """Whether all cameras stand still, so that a place that was seen stays in view."""
    when_gone: Literal["remove", "mark"] = "remove"
    """What happens to a lost entity that perception created. An operator's entity is always marked."""

    @property
    def for_moving_camera(self) -> TrackingConfig:
        """Return the settings for frames of which a camera moves.

        Such a camera soon sees more of a cut thing, and other things of the same kind. A chair that appears
        two metres from a vanished one is another chair.
        """
        return replace(
            self,
            part_frames=2 * self.part_frames,
            vanished_frames=self.vanished_frames + 2,
            pushed_m=min(self.pushed_m, 0.6),
            still_camera=False,
        )


@dataclass(frozen=True)
class DetectorConfig:
    """The model of a detector: the arguments of `DetectorModel`."""

    model: Path
    names: Path | None = None
    layout: str = ""
    least_score: float = LEAST_SCORE


@dataclass(frozen=True)
class RobotMaskConfig:
    """The robot that is left out of frames: its name on `semmap/robot/<name>`, and its MJCF or URDF file."""

    name: str
    model: Path


@dataclass(frozen=True)
class PerceptionConfig:
    """Settings of the perception node."""

    tracking: TrackingConfig = field(default_factory=TrackingConfig)
    network: Network = field(default_factory=Network)
    labels: Mapping[str, str] = field(default_factory=dict)
    """Maps the labels of an external detector to classes. Class names need no entry."""
    lessons: Path | None = None
    """The file of exemplars. Without it, exemplars are lost at exit."""
    detector: DetectorConfig | None = None
    """A detector that runs on the colour images of all cameras without masks of an external one."""
    robot: RobotMaskConfig | None = None
