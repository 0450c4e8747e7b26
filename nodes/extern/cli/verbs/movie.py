"""The verb `movie`: a span of the map's history as a video."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import click

from semmap.nodes.extern.cli.calling import TIME, connect_option, identity_option, namespace_option
from semmap.nodes.extern.cli.output.printable import say
from semmap.nodes.runtime import playback_clock
from semmap.schemas import errors

_path = click.Path(path_type=Path)
_SIZE, _FPS = (960, 640), 20


@click.command()
@click.argument("file", type=_path)
@click.option("--since", metavar="COMMIT|TIME", help="Begin with the map as it was then. Default: the first.")
@click.option("--until", metavar="COMMIT|TIME", help=f"End with the map as it was then. Default: now. {TIME}")
@click.option(
    "--speed", type=float, default=1.0, show_default=True, metavar="X", help="So many times as fast."
)
@click.option(
    "--longest",
    type=float,
    default=playback_clock.LONGEST_S,
    show_default=True,
    metavar="S",
    help="Show no commit for longer than S seconds.",
)
@click.option("--size", nargs=2, type=int, default=_SIZE, show_default=True, metavar="W H")
@click.option("--fps", type=int, default=_FPS, show_default=True, help="Pictures a second.")
@click.option("--camera", default="", metavar="NAME", help="A camera of the world. Default: all from above.")
@click.option("--place", metavar="NAME", help="Only this place, from above.")
@click.option("--world", type=_path, help="Scene file. Default: the one that the map was last run with.")
@click.option("--data", type=_path, help="The map's data folder. Default: a running system.")
@click.option("--overwrite", is_flag=True, help="Replace FILE if it exists.")
@connect_option
@identity_option
@namespace_option
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
    """Film a span of the map's history (MP4).

    Things glide, come and go as the commits say, with names of what changes and
    a caption for each commit. With OpenGL where there is one, else ray-cast,
    which takes longer. The map is only read, and may be in use meanwhile.
    """
    from semmap.nodes.extern.movie import Film
    from semmap.nodes.extern.movie import movie as make

    if world is not None and not world.is_file():
        raise errors.BadFile(f"there is no file {world}")
    film = Film(longest_s=longest, world=world, **wanted)
    of_whom = {"where": where, "identity": identity, "namespace": namespace}
    say(make(file, film, data=data, overwrite=overwrite, tell=_progress, **of_whom))


def _progress(text: str) -> None:
    """How far it is, on one line that is written over; nothing where nobody looks."""
    if sys.stderr.isatty():
        print(f"\r{text}\x1b[K", end="\r", file=sys.stderr, flush=True)
