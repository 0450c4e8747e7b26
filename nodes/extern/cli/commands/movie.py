"""The command `movie`: a video of a period of the history."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import click

from semmap.nodes.extern.cli.command import command
from semmap.nodes.extern.cli.common import (
    TIME,
    connect_option,
    identity_option,
    json_option,
    namespace_option,
    print_file,
)
from semmap.nodes.runtime import playback_clock
from semmap.schemas import errors

_path = click.Path(path_type=Path)
_SIZE, _FPS = (960, 640), 20


@command(example="semmap movie morning.mp4 --since 08:00 --until 09:00 --speed 10")
@click.argument("file", type=_path)
@click.option("--since", metavar="COMMIT|TIME", help="Start of the period. Default: the first commit.")
@click.option("--until", metavar="COMMIT|TIME", help=f"End of the period. Default: now. {TIME}")
@click.option(
    "--speed", type=float, default=1.0, show_default=True, metavar="X", help="Playback speed factor."
)
@click.option(
    "--longest",
    type=float,
    default=playback_clock.LONGEST_S,
    show_default=True,
    metavar="S",
    help="Maximum duration of a commit in the video.",
)
@click.option(
    "--size", nargs=2, type=int, default=_SIZE, show_default=True, metavar="W H", help="Size [pixel]."
)
@click.option("--fps", type=int, default=_FPS, show_default=True, help="Frames per second.")
@click.option("--camera", default="", metavar="NAME", help="Camera of the world. Default: view from above.")
@click.option("--place", metavar="NAME", help="Only this place, from above.")
@click.option("--world", type=_path, help="Scene file. Default: the last world of the map.")
@click.option("--data", type=_path, help="Data folder of the map. Default: a running system.")
@click.option("--overwrite", is_flag=True, help="Replace FILE if it exists.")
@connect_option
@identity_option
@namespace_option
@json_option
def movie(
    file: Path,
    data: Path | None,
    world: Path | None,
    longest: float,
    overwrite: bool,
    where: str | None,
    identity: str | None,
    namespace: str | None,
    **wanted: Any,
) -> None:
    """Export a video of a period of the history (MP4).

    The video shows how objects move, appear and disappear, with the names of changed objects and a caption
    for each commit. It is rendered with OpenGL or, where OpenGL is not available, by slower ray casting. The
    map is only read; its system may be running.
    """
    from semmap.nodes.extern.movie import Film
    from semmap.nodes.extern.movie import movie as make

    if world is not None and not world.is_file():
        raise errors.BadFile(f"there is no file {world}")
    film = Film(longest_s=longest, world=world, **wanted)
    system = {"where": where, "identity": identity, "namespace": namespace}
    print_file(file, make(file, film, data=data, overwrite=overwrite, tell=_progress, **system))


def _progress(text: str) -> None:
    """Print the progress in a terminal, on a line that the next text overwrites."""
    if sys.stderr.isatty():
        print(f"\r{text}\x1b[K", end="\r", file=sys.stderr, flush=True)
