"""The verbs about the scene: `move`, `pause`, `step`, `reset`, `picture`, `replay`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from nodes.extern.cli.calling import given, talks, vector_option
from nodes.extern.cli.completing import entity_names
from nodes.extern.client import Client
from nodes.extern.files import write_atomically
from nodes.runtime import extras
from schemas import errors


@click.command()
@click.argument("name", shell_complete=entity_names)
@vector_option("--at", metavar="X Y Z", required=True, help="Where the hand lets go: bottom centre [m].")
@click.option("--yaw", type=float, metavar="RAD")
@talks
def move(client: Client, name: str, at: Any, yaw: float | None) -> None:
    """Take a body and put it elsewhere, as a hand would; the map follows when it rests."""
    print(client.move(**given({"name": name, "at": at, "yaw": yaw})).text)


@click.command()
@click.option("--off/--on", "off", default=False, help="Let time run, or stop it.  [default: on]")
@talks
def pause(client: Client, off: bool) -> None:
    """Stop simulated time, or let it run again."""
    print(client.pause(off=off).text)


@click.command()
@click.argument("seconds", type=float, default=0.1)
@talks
def step(client: Client, seconds: float) -> None:
    """Let paused time go on by SECONDS, 60 at most, a tenth of one unless told otherwise."""
    print(client.step(seconds).text)


@click.command()
@talks
def reset(client: Client) -> None:
    """Put every body back where the map says; what could not be made is tried again."""
    print(client.reset().text)


@click.command()
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--camera", metavar="NAME", help="A camera of the world; without one, all from aloft.")
@click.option("--width", type=int, default=960, show_default=True)
@click.option("--height", type=int, default=720, show_default=True)
@talks
def picture(client: Client, file: Path, camera: str | None, width: int, height: int) -> None:
    """Write a picture of the scene to FILE (PNG)."""
    if file.suffix.lower() != ".png":
        raise errors.BadRequest(f"pictures are PNG; call the file {file.stem or 'scene'}.png")
    write_atomically(file, client.picture(camera, width=width, height=height))
    print(f"wrote {file}")


@click.command()
@click.argument("file", type=click.Path(path_type=Path))
def replay(file: Path) -> None:
    """Open a recording in the Rerun viewer."""
    extras.require("semmap replay", "record")
    from nodes.recorder.replay import replay as open_viewer

    open_viewer(file)
