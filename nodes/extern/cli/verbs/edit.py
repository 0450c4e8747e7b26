"""The verbs that change the map: `add`, `update`, `remove`, `clear`, `load`."""

from __future__ import annotations

import functools
from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

from nodes.extern.cli.calling import given, print_lines, talks, vector_option
from nodes.extern.cli.completing import class_names, entity_names
from nodes.extern.cli.ontology_options import import_option, spatial_root_option
from nodes.extern.cli.output import show
from nodes.extern.cli.output.load_progress import progress
from nodes.extern.client import Client
from schemas import errors


def _options(*decorators: Callable[[Any], Any]) -> Callable[[Any], Any]:
    return lambda function: functools.reduce(lambda f, decorate: decorate(f), reversed(decorators), function)


_describing = _options(
    vector_option("--at", metavar="X Y Z", help="Position of the bottom centre in the map frame [m]."),
    click.option("--yaw", type=float, metavar="RAD", help="Rotation about the z axis [rad]."),
    click.option("--orientation", nargs=4, type=float, metavar="W X Y Z", help="Unit quaternion."),
    vector_option("--size", metavar="X Y Z", help="Size along its own axes [m]."),
    click.option("--ref", metavar="TEXT", help="Preferred reference: what people call it."),
    click.option("--alt", multiple=True, metavar="TEXT", help="Alternative reference; may be repeated."),
    click.option("--confidence", type=float, metavar="P", help="Confidence, 0 to 1."),
    click.option("--wait", is_flag=True, help="Wait until its body stands in the scene."),
    click.option(
        "--id", "id", metavar="ID", help="Command id; a command sent twice with one id is executed once."
    ),
)


@click.command()
@click.argument("class_", metavar="CLASS", shell_complete=class_names)
@click.argument("name", required=False)
@_describing
@click.option("--default", is_flag=True, help="Use the next free place and the class's label as reference.")
@talks
def add(client: Client, **fields: Any) -> None:
    """Add an entity to the map."""
    print_lines(show.changed(client.add(**given(fields))))


@click.command()
@click.argument("name", shell_complete=entity_names)
@_describing
@click.option("--class", "class_", metavar="CLASS", shell_complete=class_names)
@click.option(
    "--conflict",
    metavar="TEXT",
    help="Record an observation that contradicts the map; an empty text clears it.",
)
@talks
def update(client: Client, **fields: Any) -> None:
    """Change an entity; omitted fields keep their values."""
    print_lines(show.changed(client.update(**given(fields))))


@click.command()
@click.argument("names", nargs=-1, required=True, shell_complete=entity_names)
@talks
def remove(client: Client, names: tuple[str, ...]) -> None:
    """Remove entities from the map and the scene."""
    print_lines(show.changed(client.remove(*names)))


@click.command()
@talks
def clear(client: Client) -> None:
    """Remove all entities from the map and the scene; the TBox stays."""
    print_lines(show.changed(client.clear()))


@click.command()
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--replace", is_flag=True, help="Replace the present entities.")
@click.option("--skip-unknown", is_flag=True, help="Skip entities of unknown classes.")
@click.option("--strict", is_flag=True, help="Refuse what speaks of things that nobody says what they are.")
@click.option("--tbox", is_flag=True, help="FILE is a TBox (or a folder) in place of the present one.")
@click.option("--parts", is_flag=True, help="As many commits as it takes, for files of any size.")
@import_option
@spatial_root_option
@talks
def load(client: Client, file: Path, imports: tuple[tuple[str, Path], ...], **how: Any) -> None:
    """Load an ABox in any syntax of RDF or OWL, a JSON scene or a HuRIC map; or a TBox with its imports."""
    with progress(client):
        try:
            reply = client.load(file, imports=dict(imports), **how)
        except errors.NoAnswer as error:
            raise errors.NoAnswer(
                f"{error.text}; whether {file.name} was loaded is not known here: semmap history tells"
            ) from None
    print_lines(show.changed(reply))
