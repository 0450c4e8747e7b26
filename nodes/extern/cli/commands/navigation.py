"""The verbs for robots that drive: `floorplan`, `route`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from semmap.nodes.extern.cli.command import NegativeNumbers, command
from semmap.nodes.extern.cli.common import print_json, with_client
from semmap.nodes.extern.cli.output.printable import print_escaped
from semmap.nodes.extern.cli.shell_completion import entity_names
from semmap.schemas.plans import HEIGHTS_M, RADIUS_M

if TYPE_CHECKING:
    from semmap.nodes.extern.client import Client

_as_of = click.option("--as-of", metavar="COMMIT|TIME", help="The map as it was then.")
_height_range = click.option(
    "--height-range",
    "heights",
    nargs=2,
    type=float,
    default=HEIGHTS_M,
    show_default=True,
    metavar="LOW HIGH",
    help="What has a part between these heights above the floor [m] is in the robot's way.",
)


@command(example="semmap floorplan flat.png --resolution 0.05")
@click.argument("file", type=click.Path(path_type=Path))
@click.option(
    "--resolution", type=float, default=0.05, show_default=True, metavar="M", help="Metres a pixel."
)
@_height_range
@click.option("--no-furniture", is_flag=True, help="Walls only.")
@_as_of
@with_client
def floorplan(client: Client, file: Path, no_furniture: bool, **how: Any) -> None:
    """Write a floor plan to FILE.

    A .png or .pgm is an occupancy grid with a .yaml beside it, as ROS's map server takes them, furniture
    as it stands; if places are forbidden (isForbidden), with a mask of them. A .svg is for people, a
    .geojson for programs.
    """
    from semmap.nodes.extern.floorplans import write_floorplan

    for path in write_floorplan(client, file, furniture=not no_furniture, **how):
        print_escaped(f"wrote {path}")


@command(example="semmap route bedroom1 kitchen1 --radius 0.3", cls=NegativeNumbers)
@click.argument("start", metavar="FROM", shell_complete=entity_names)
@click.argument("end", metavar="TO", shell_complete=entity_names)
@click.option(
    "--radius", type=float, default=RADIUS_M, show_default=True, metavar="M", help="Half the robot's width."
)
@_height_range
@_as_of
@click.option("--format", "form", type=click.Choice(["text", "json"]), default="text", show_default=True)
@with_client
def route(client: Client, start: str, end: str, form: str, **how: Any) -> None:
    """Find the shortest way over places and through doors.

    FROM and TO are places, things or persons, by name, reference or class, or positions: 2.5,1. Ends with
    status 1 where there is no way, or none is open.
    """
    way = client.route(start, end, **how)
    if form == "json":
        print_json(way)
    else:
        print_escaped(way.text)
        for note in way.notes:
            print_escaped(f"  note: {note}")
    if way.closed:
        raise SystemExit(1)
