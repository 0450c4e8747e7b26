"""What a movie is to be like."""

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
"""The caption is one part in so many of the height."""


class Film(Struct, frozen=True, kw_only=True):
    """The span, from one commit or time to another, and how it is seen.

    `world` is the scene file, None for a bare floor; `models` is a folder of model files, `data` the map's.
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
    """False casts rays, also where there is OpenGL."""

    def require_sound(self) -> None:
        """Raises BadRequest for what no movie can be like."""
        playback_clock.require_speed(self.speed)
        playback_clock.require_longest(self.longest_s)
        if not all(_SMALLEST <= length <= _LARGEST for length in self.size):
            width, height = self.size
            raise BadRequest(
                f"--size {width} {height} is not possible: choose {_SMALLEST} to {_LARGEST} pixels for each"
            )
        if not 1 <= self.fps <= 60:
            raise BadRequest(f"--fps {self.fps} is not possible: choose 1 to 60 pictures a second")
        if self.camera and self.place is not None:
            raise BadRequest("give either a camera or a place")

    @property
    def even_size(self) -> tuple[int, int]:
        """Width and height of the movie [pixel]: a video has even ones."""
        width, height = self.size
        return width - width % 2, height - height % 2

    @property
    def picture_size(self) -> tuple[int, int]:
        """Those of its pictures, above the caption."""
        width, height = self.even_size
        return width, height - max(16, height // _CAPTION)
