"""The commands for robot navigation: `floorplan`, `route`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from semmap.nodes.extern.cli.command import NegativeNumbers, command
from semmap.nodes.extern.cli.common import json_option, print_json, print_lines, print_result, with_client
from semmap.nodes.extern.cli.shell_completion import entity_names
from semmap.schemas.plans import HEIGHTS_M, RADIUS_M

if TYPE_CHECKING:
    from semmap.nodes.extern.client import Client

_as_of = click.option("--as-of", metavar="COMMIT|TIME", help="State of the map at a commit or time.")
_height_range = click.option(
    "--height-range",
    "heights",
    nargs=2,
    type=float,
    default=HEIGHTS_M,
    show_default=True,
    metavar="LOW HIGH",
    help="Objects with a part between these heights above the floor [m] are obstacles.",
)


@command(example="semmap floorplan flat.png --resolution 0.05")
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--resolution", type=float, default=0.05, show_default=True, metavar="M", help="Cell size [m].")
@_height_range
@click.option("--no-furniture", is_flag=True, help="Walls only.")
@_as_of
@json_option
@with_client
def floorplan(client: Client, file: Path, no_furniture: bool, **how: Any) -> None:
    """Write a floor plan to FILE.

    A .png or .pgm file is an occupancy grid with a .yaml file, as the ROS map server reads them. It includes
    the furniture; forbidden places (isForbidden) are written to a separate mask. A .svg file is a drawing for
    people, a .geojson file is for programs.
    """
    from semmap.nodes.extern.floorplans import write_floorplan

    files = write_floorplan(client, file, furniture=not no_furniture, **how)
    print_result({"files": list(map(str, files))}, lambda _: [f"wrote {path}" for path in files])


@command(example="semmap route bedroom1 kitchen1 --radius 0.3", cls=NegativeNumbers)
@click.argument("start", metavar="FROM", shell_complete=entity_names)
@click.argument("end", metavar="TO", shell_complete=entity_names)
@click.option(
    "--radius", type=float, default=RADIUS_M, show_default=True, metavar="M", help="Radius of the robot [m]."
)
@_height_range
@_as_of
@click.option("--format", "form", type=click.Choice(["text", "json"]), default="text", show_default=True)
@with_client
def route(client: Client, start: str, end: str, form: str, **how: Any) -> None:
    """Find the shortest route through places and doors.

    FROM and TO are positions, such as 2.5,1, or entities, by name, label or class. The exit status is 1 if
    there is no route, or if doors on the route are closed.
    """
    found = client.route(start, end, **how)
    if form == "json":
        print_json(found)
    else:
        print_lines([found.text, *(f"note: {note}" for note in found.notes)])
    if found.closed:
        raise SystemExit(1)
