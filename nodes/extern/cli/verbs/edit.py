"""The verbs that change the map: `add`, `update`, `remove`, `clear`, `load`."""

from __future__ import annotations

import functools
from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

from nodes.extern.cli.calling import given, print_lines, talks, vector_option
from nodes.extern.cli.completing import class_names, entity_names
from nodes.extern.cli.output import show
from nodes.extern.cli.output.load_progress import progress
from nodes.extern.client import Client


def _options(*decorators: Callable[[Any], Any]) -> Callable[[Any], Any]:
    return lambda function: functools.reduce(lambda f, decorate: decorate(f), reversed(decorators), function)


_describing = _options(
    vector_option("--at", metavar="X Y Z", help="Bottom centre in the map frame [m]."),
    click.option("--yaw", type=float, metavar="RAD", help="Rotation about z."),
    click.option("--orientation", nargs=4, type=float, metavar="W X Y Z", help="Unit quaternion."),
    vector_option("--size", metavar="X Y Z", help="Extent along its own axes [m]."),
    click.option("--ref", metavar="TEXT", help="What people call it."),
    click.option("--alt", multiple=True, metavar="TEXT", help="What they call it too; may be repeated."),
    click.option("--confidence", type=float, metavar="P", help="How sure that is, 0 to 1."),
    click.option("--wait", is_flag=True, help="Reply when its body stands in the scene."),
    click.option("--id", "id", metavar="ID", help="Command id: the same one twice is executed once."),
)


@click.command()
@click.argument("class_", metavar="CLASS", shell_complete=class_names)
@click.argument("name", required=False)
@_describing
@click.option("--default", is_flag=True, help="At the next free place, named and called after its class.")
@talks
def add(client: Client, **fields: Any) -> None:
    """Put an entity into the map."""
    print_lines(show.changed(client.add(**given(fields))))


@click.command()
@click.argument("name", shell_complete=entity_names)
@_describing
@click.option("--class", "class_", metavar="CLASS", shell_complete=class_names)
@click.option("--conflict", metavar="TEXT", help="What is seen against it; an empty text takes that back.")
@talks
def update(client: Client, **fields: Any) -> None:
    """Change what is named; what is not named stays."""
    print_lines(show.changed(client.update(**given(fields))))


@click.command()
@click.argument("names", nargs=-1, required=True, shell_complete=entity_names)
@talks
def remove(client: Client, names: tuple[str, ...]) -> None:
    """Take entities out of map and scene."""
    print_lines(show.changed(client.remove(*names)))


@click.command()
@talks
def clear(client: Client) -> None:
    """Take every entity out of map and scene; the TBox stays."""
    print_lines(show.changed(client.clear()))


@click.command()
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--replace", is_flag=True, help="Instead of the present map.")
@click.option("--skip-unknown", is_flag=True, help="Leave out what is of an unknown class.")
@click.option("--tbox", is_flag=True, help="FILE is a TBox that takes the place of the present one.")
@talks
def load(client: Client, file: Path, replace: bool, skip_unknown: bool, tbox: bool) -> None:
    """Load an ABox (RDF/XML, Turtle, N-Triples, JSON-LD), a JSON scene or a HuRIC map; or a TBox."""
    with progress(client):
        reply = client.load(file, replace=replace, skip_unknown=skip_unknown, tbox=tbox)
    print_lines(show.changed(reply))
