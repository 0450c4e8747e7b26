"""The commands about the scene, from `move` and `attach` to `picture`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from semmap.nodes.extern.cli.angles import yaw_option
from semmap.nodes.extern.cli.command import NegativeNumbers, command
from semmap.nodes.extern.cli.common import (
    carry_options,
    drop_unset,
    frame_option,
    json_option,
    placing_options,
    print_file,
    print_result,
    print_text,
    vector_option,
    with_client,
)
from semmap.nodes.extern.cli.output import lines
from semmap.nodes.extern.cli.shell_completion import entity_names
from semmap.nodes.extern.files import write_atomically
from semmap.schemas import errors

if TYPE_CHECKING:
    from semmap.nodes.extern.client import Client


_WAIT = click.option(
    "--wait/--no-wait",
    default=True,
    help="Wait until the map is updated, or return immediately.  [default: wait]",
)


@command(example="semmap move cup1 --at 2.5 1 0.75")
@click.argument("name", shell_complete=entity_names)
@vector_option("--at", metavar="X Y Z", help="New position of the bottom centre [m].")
@placing_options
@frame_option("Frame of --at and --yaw. Default: map")
@yaw_option
@carry_options
@_WAIT
@json_option
@with_client
def move(client: Client, wait: bool, **fields: Any) -> None:
    """Move the body of an entity manually.

    The map is updated when the body comes to rest. While time is paused, the command does not wait.
    """
    print_result(client.move(**drop_unset(fields), wait=wait), lines.format_move)


@command(example="semmap attach cup1 --to robot1_gripper", cls=NegativeNumbers)
@click.argument("name", shell_complete=entity_names)
@click.option(
    "--to", required=True, metavar="HOLDER", help="Entity to attach to, such as a gripper or a tray."
)
@vector_option(
    "--at", metavar="X Y Z", help="Position in the frame of HOLDER [m].  [default: current position]"
)
@yaw_option
@carry_options
@click.option("--force", is_flag=True, help="Attach an entity that is more than 0.3 m away.")
@click.option("--dry-run", is_flag=True, help="Report what would change, without changing anything.")
@json_option
@with_client
def attach(client: Client, **fields: Any) -> None:
    """Attach an entity to another one, such as a gripper.

    It moves with HOLDER until it is detached. With --carry, the objects on it and inside it are attached to
    it at their current poses, and are detached with it.
    """
    print_result(client.attach(**drop_unset(fields)), lines.format_change)


@command(example="semmap detach cup1")
@click.argument("name", shell_complete=entity_names)
@click.option("--dry-run", is_flag=True, help="Report what would change, without changing anything.")
@json_option
@with_client
def detach(client: Client, name: str, dry_run: bool) -> None:
    """Detach an entity.

    Objects that were attached with it (--carry) are also detached.
    """
    print_result(client.detach(name, dry_run=dry_run), lines.format_change)


_JOINT = click.option("--joint", metavar="JOINT", help="Only this door, drawer or switch of the object.")


@command("open", example="semmap open fridge1 --to 0.5")
@click.argument("name", shell_complete=entity_names)
@click.option("--to", type=float, default=1.0, help="Openness, from 0 to 1.  [default: 1]")
@_JOINT
@_WAIT
@json_option
@with_client
def open_(client: Client, name: str, to: float, joint: str | None, wait: bool) -> None:
    """Open a door, lid or drawer.

    The map is updated when the door comes to rest.
    """
    print_result(client.open(name, to=to, joint=joint, wait=wait), lines.format_move)


@command(example="semmap close fridge1")
@click.argument("name", shell_complete=entity_names)
@_JOINT
@_WAIT
@json_option
@with_client
def close(client: Client, name: str, joint: str | None, wait: bool) -> None:
    """Close a door, lid or drawer.

    The map is updated when the door comes to rest.
    """
    print_result(client.close(name, joint=joint, wait=wait), lines.format_move)


@command(example="semmap drive robot1 --to 2 1 --to 4 1.5 --yaw 90deg", cls=NegativeNumbers)
@click.argument("name", shell_complete=entity_names)
@click.option(
    "--to",
    nargs=2,
    type=float,
    multiple=True,
    metavar="X Y",
    help="Waypoint on the floor [m]; may be repeated.",
)
@frame_option("Frame of --to and --yaw at the start of the command. Default: map")
@yaw_option
@click.option("--speed", type=float, default=0.4, show_default=True, help="Maximum speed [m/s].")
@click.option("--stop", is_flag=True, help="Stop at the current position.")
@_WAIT
@json_option
@with_client
def drive(client: Client, wait: bool, **fields: Any) -> None:
    """Drive a simulated robot to a point.

    The robot drives to each waypoint in a straight line. It does not plan around obstacles.
    """
    print_result(client.drive(**drop_unset(fields), wait=wait), lines.format_move)


@command(example="semmap pause")
@click.option("--off/--on", "off", default=False, help="Resume or pause time.  [default: on]")
@json_option
@with_client
def pause(client: Client, off: bool) -> None:
    """Pause simulated time, or resume it."""
    print_text(client.pause(off=off))


@command(example="semmap step 0.5", cls=NegativeNumbers)
@click.argument("seconds", type=float, default=0.1)
@json_option
@with_client
def step(client: Client, seconds: float) -> None:
    """Advance paused time by SECONDS (default 0.1, at most 60)."""
    print_text(client.step(seconds))


@command(example="semmap reset")
@json_option
@with_client
def reset(client: Client) -> None:
    """Move every body to its pose in the map.

    The creation of failed bodies is retried.
    """
    print_text(client.reset())


@command(example="semmap picture kitchen.png --place kitchen1 --labels")
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--camera", metavar="NAME", help="Camera of the world. Default: view from above.")
@click.option("--place", metavar="NAME", help="Only this place, from above.")
@click.option("--labels", is_flag=True, help="Draw the names of the objects.")
@click.option("--width", type=int, default=960, show_default=True, help="Width [pixel].")
@click.option("--height", type=int, default=720, show_default=True, help="Height [pixel].")
@json_option
@with_client
def picture(
    client: Client, file: Path, camera: str | None, place: str | None, labels: bool, width: int, height: int
) -> None:
    """Render the scene to FILE (PNG)."""
    if file.suffix.lower() != ".png":
        raise errors.BadRequest(f"{file}: the suffix must be .png, as in {file.stem or 'scene'}.png")
    write_atomically(file, client.picture(camera, place=place, labels=labels, width=width, height=height))
    print_file(file, f"wrote {file}")
