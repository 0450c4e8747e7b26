"""The verb of frames: `frames`."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from nodes.extern.cli import output
from nodes.extern.cli.calling import print_json, talks
from nodes.extern.cli.completing import entity_names

if TYPE_CHECKING:
    from nodes.extern.client import Client


@click.command()
@click.argument("name", required=False, shell_complete=entity_names)
@click.option("--format", "format", type=click.Choice(["tree", "json"]), default="tree", show_default=True)
@talks
def frames(client: Client, name: str | None, format: str) -> None:
    """Show the tree of frames, each with its pose in its parent.

    Frames are the map, entities, cameras, and what others publish. With NAME that frame, those above it and
    those below it.
    """
    found = client.frames(name)
    if format == "json":
        print_json(found)
    else:
        output.show.console().print(output.show.frame_tree(found))
