"""The settings of a video."""

from __future__ import annotations

from pathlib import Path
from typing import Final

from msgspec import Struct

from semmap.nodes.runtime import playback_clock
from semmap.schemas.errors import BadRequest
from semmap.schemas.moments import When

SIZE: Final = (960, 640)
FPS: Final = 20
_SMALLEST, _LARGEST = 160, 1440
_CAPTION: Final = 18
"""The height of the video divided by that of the caption."""


class Film(Struct, frozen=True, kw_only=True):
    """The settings of a video: the period, from one commit or time to another, and the view.

    `world` is the scene file; None is an empty world. `models` is a folder of model files, and `data` the
    data folder of the map.
    """

    since: When | None = None
    until: When | None = None
    speed: float = 1.0
    longest_s: float = playback_clock.LONGEST_S
    size: tuple[int, int] = SIZE
    fps: int = FPS
    camera: str = ""
    place: str | None = None
    world: Path | None = None
    models: Path | None = None
    data: Path | None = None
    graphics: bool = True
    """False uses ray casting, even if OpenGL is available."""

    def require_sound(self) -> None:
        """Raise BadRequest for invalid settings."""
        playback_clock.require_speed(self.speed)
        playback_clock.require_longest(self.longest_s)
        if not all(_SMALLEST <= length <= _LARGEST for length in self.size):
            width, height = self.size
            raise BadRequest(
                f"--size {width} {height} is out of range; use {_SMALLEST} to {_LARGEST} pixels for each"
            )
        if not 1 <= self.fps <= 60:
            raise BadRequest(f"--fps {self.fps} is out of range; use 1 to 60")
        if self.camera and self.place is not None:
            raise BadRequest("--camera and --place exclude each other; remove one of them")

    @property
    def even_size(self) -> tuple[int, int]:
        """Width and height of the video [pixel], which must be even."""
        width, height = self.size
        return width - width % 2, height - height % 2

    @property
    def picture_size(self) -> tuple[int, int]:
        """Width and height of the images above the caption [pixel]."""
        width, height = self.even_size
        return width, height - max(16, height // _CAPTION)
