"""The verbs that change the map: `add`, `update`, `set`, `unset`, `track`, `remove`, `clear`, `load`."""

from __future__ import annotations

import functools
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from semmap.nodes.extern.cli.angles import yaw_option
from semmap.nodes.extern.cli.calling import carrying, frame_option, given, print_lines, talks, vector_option
from semmap.nodes.extern.cli.completing import class_names, entity_names
from semmap.nodes.extern.cli.negative_numbers import NegativeNumbers
from semmap.nodes.extern.cli.ontology_options import (
    import_option,
    require_there,
    spatial_root_option,
    tbox_file,
)
from semmap.nodes.extern.cli.output import lines
from semmap.nodes.extern.cli.output.printable import say
from semmap.nodes.extern.plan_files import is_plan, read_plan
from semmap.schemas import errors

if TYPE_CHECKING:
    from semmap.nodes.extern.client import Client


def _options(*decorators: Callable[[Any], Any]) -> Callable[[Any], Any]:
    return lambda function: functools.reduce(lambda f, decorate: decorate(f), reversed(decorators), function)


def _stated(fields: dict[str, Any]) -> dict[str, Any]:
    """The options that were given; a value may be an empty text."""
    return {name: value for name, value in fields.items() if value not in (None, False)}


_id = click.option(
    "--id", "id", metavar="ID", help="Command id; a command sent twice with one id is executed once."
)
_dry_run = click.option(
    "--dry-run", is_flag=True, help="Report what would change, without changing anything."
)
_set = click.option(
    "--set", "set", multiple=True, metavar="PROPERTY=VALUE", help="State a property; may be repeated."
)
_if_is = click.option("--if-is", metavar="VALUE", help="Only if this is a value now (compare and set).")
_describing = _options(
    vector_option("--at", metavar="X Y Z", help="Position of the bottom centre [m]."),
    frame_option("The frame of --at and the angle, instead of the map's"),
    yaw_option,
    click.option("--orientation", nargs=4, type=float, metavar="W X Y Z", help="Unit quaternion."),
    vector_option("--size", metavar="X Y Z", help="Size along its own axes [m]."),
    click.option("--extent", metavar="WKT", help="What a place covers: 'POLYGON ((X Y, ...))' [m]."),
    click.option("--ref", metavar="TEXT", help="Preferred reference: what people call it."),
    click.option("--alt", multiple=True, metavar="TEXT", help="Alternative reference; may be repeated."),
    click.option("--confidence", type=float, metavar="P", help="Confidence, 0 to 1."),
    click.option("--wait", is_flag=True, help="Wait until its body stands in the scene."),
    _id,
)


@click.command()
@click.argument("class_", metavar="CLASS", shell_complete=class_names)
@click.argument("name", required=False)
@_describing
@_set
@click.option(
    "--track", type=click.Choice(["stream", "sim"]), help="Track it from the start (see: semmap track)."
)
@click.option("--default", is_flag=True, help="Fill in the class's label as reference, too.")
@_dry_run
@talks
def add(client: Client, **fields: Any) -> None:
    """Add an entity to the map.

    Without --at it goes to the next free place.
    """
    print_lines(lines.changed(client.add(**given(fields))))


@click.command()
@click.argument("name", shell_complete=entity_names)
@_describing
@click.option("--class", "class_", metavar="CLASS", shell_complete=class_names)
@click.option(
    "--conflict",
    metavar="TEXT",
    help="Record an observation that contradicts the map; an empty text clears it.",
)
@_set
@click.option(
    "--unset",
    multiple=True,
    metavar="PROPERTY[=VALUE]",
    help="Remove a value of a property, or all; with --set of the same property they are replaced.",
)
@click.option("--force", is_flag=True, help="Allow an object to become a place, or a place an object.")
@carrying
@_dry_run
@talks
def update(client: Client, **fields: Any) -> None:
    """Change an entity; omitted fields keep their values."""
    print_lines(lines.changed(client.update(**given(fields))))


@click.command("set", cls=NegativeNumbers)
@click.argument("name", shell_complete=entity_names)
@click.argument("property", metavar="PROPERTY")
@click.argument("values", metavar="VALUE...", nargs=-1, required=True)
@_if_is
@click.option("--if-unset", is_flag=True, help="Only if the property has no value now.")
@click.option("--confidence", type=float, metavar="P", help="Confidence, 0 to 1.")
@_id
@_dry_run
@talks
def set_(client: Client, name: str, property: str, values: tuple[str, ...], **fields: Any) -> None:
    """State a property of an entity: semmap set door1 isOpen true.

    The value of a functional property replaces the one before; other properties get more values.
    """
    print_lines(lines.changed(client.set(name, property, *values, **_stated(fields))))


@click.command(cls=NegativeNumbers)
@click.argument("name", shell_complete=entity_names)
@click.argument("property", metavar="PROPERTY")
@click.argument("value", required=False)
@_if_is
@_id
@_dry_run
@talks
def unset(client: Client, **fields: Any) -> None:
    """Take back one value of an entity's property, or all."""
    print_lines(lines.changed(client.unset(**_stated(fields))))


@click.command()
@click.argument("name", shell_complete=entity_names)
@click.option(
    "--from",
    "from_",
    type=click.Choice(["stream", "sim"]),
    default="stream",
    show_default=True,
    help="Who tells its pose: programs that publish it, or the simulator.",
)
@click.option("--off", is_flag=True, help="Stop tracking it; it stays where it was last.")
@_id
@_dry_run
@talks
def track(client: Client, **fields: Any) -> None:
    """Let an entity's pose come live, on semmap/live/NAME.

    The newest pose wins and costs no commit; where the entity stops, its pose is committed.
    """
    print_lines(lines.changed(client.track(**given(fields))))


@click.command()
@click.argument("names", nargs=-1, required=True, shell_complete=entity_names)
@_dry_run
@talks
def remove(client: Client, names: tuple[str, ...], dry_run: bool) -> None:
    """Remove entities from the map and the scene."""
    print_lines(lines.changed(client.remove(*names, dry_run=dry_run)))


@click.command()
@_dry_run
@talks
def clear(client: Client, dry_run: bool) -> None:
    """Remove all entities from the map and the scene."""
    from semmap.nodes.extern.cli.output.progress import progress

    with progress(client):
        reply = client.clear(dry_run=dry_run)
    print_lines(lines.changed(reply))


@click.command()
@click.argument("file", type=click.Path())
@click.option("--replace", is_flag=True, help="Replace the present entities.")
@click.option("--skip-unknown", is_flag=True, help="Skip entities of unknown classes.")
@click.option("--strict", is_flag=True, help="Refuse files that refer to undescribed things.")
@click.option(
    "--tbox", is_flag=True, help="FILE (or folder, or household) is a TBox that replaces the present one."
)
@click.option("--extend", is_flag=True, help="With --tbox: add FILE to the present TBox.")
@click.option("--parts", is_flag=True, help="Load in several commits, for files of any size.")
@import_option
@spatial_root_option
@_dry_run
@talks
def load(client: Client, file: str, imports: tuple[tuple[str, Path], ...], **how: Any) -> None:
    """Load a map, a scene or a TBox from a file.

    A map is an ABox in any syntax of RDF or OWL, a JSON scene or a HuRIC map; a TBox comes with its imports.
    A plan is the .yaml of an occupancy grid of ROS's map server: its free space becomes rooms and doors.
    """
    from semmap.nodes.extern.cli.output.progress import progress

    path = tbox_file(file) if how["tbox"] else Path(file)
    if how["tbox"]:
        require_there(path)
    with progress(client):
        try:
            reply = client.load(path, imports=dict(imports), **how)
        except errors.NoAnswer as error:
            raise errors.NoAnswer(
                f"{error.text}; whether {path.name} was loaded is unknown; to find out: semmap history"
            ) from None
    print_lines(lines.changed(reply))
    if is_plan(path) and not how["tbox"]:
        for line in read_plan(path).lines:
            say(f"  {line}")
