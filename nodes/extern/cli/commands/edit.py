"""The commands that change the map: `add`, `update`, `set`, `rename`, `remove`, `load` and others."""

from __future__ import annotations

import functools
from collections.abc import Callable
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
    print_result,
    vector_option,
    with_client,
)
from semmap.nodes.extern.cli.ontology_options import (
    import_option,
    require_there,
    spatial_root_option,
    tbox_file,
)
from semmap.nodes.extern.cli.output import lines
from semmap.nodes.extern.cli.shell_completion import class_names, entity_names
from semmap.nodes.extern.floorplans import is_plan, read_plan
from semmap.schemas import errors

if TYPE_CHECKING:
    from semmap.nodes.extern.client import Client


def _options(*decorators: Callable[[Any], Any]) -> Callable[[Any], Any]:
    return lambda function: functools.reduce(lambda f, decorate: decorate(f), reversed(decorators), function)


def _drop_none(fields: dict[str, Any]) -> dict[str, Any]:
    """Return the options that were set; an empty text is a value."""
    return {name: value for name, value in fields.items() if value not in (None, False)}


_id = click.option(
    "--id", "id", metavar="ID", help="Command id; a command sent twice with one id is executed once."
)
_dry_run = click.option(
    "--dry-run", is_flag=True, help="Report what would change, without changing anything."
)
_set = click.option(
    "--set", "set", multiple=True, metavar="PROPERTY=VALUE", help="Set a property; may be repeated."
)
_if_is = click.option(
    "--if-is", metavar="VALUE", help="Only if the property has this value (compare and set)."
)
_describing = _options(
    vector_option("--at", metavar="X Y Z", help="Position of the bottom centre [m]."),
    placing_options,
    frame_option("Frame of --at and of the rotation. Default: map"),
    yaw_option,
    click.option("--orientation", nargs=4, type=float, metavar="W X Y Z", help="Unit quaternion."),
    vector_option("--size", metavar="X Y Z", help="Size along its own axes [m]."),
    click.option("--extent", metavar="WKT", help="Area of a place: 'POLYGON ((X Y, ...))' [m]."),
    click.option("--ref", metavar="TEXT", help="Label (skos:prefLabel)."),
    click.option("--alt", multiple=True, metavar="TEXT", help="Alias (skos:altLabel); may be repeated."),
    click.option("--confidence", type=float, metavar="P", help="Confidence, 0 to 1."),
    click.option(
        "--wait/--no-wait",
        default=False,
        help="Wait until its body is in the scene, or return immediately.  [default: no-wait]",
    ),
    _id,
)


@command(example='semmap add Cup cup1 --on table1 --ref "coffee cup"')
@click.argument("class_", metavar="CLASS", shell_complete=class_names)
@click.argument("name", required=False)
@_describing
@_set
@click.option(
    "--track", type=click.Choice(["stream", "sim"]), help="Track it from the start (see: semmap track)."
)
@click.option("--default", is_flag=True, help="Also use the label of the class as label.")
@_dry_run
@json_option
@with_client
def add(client: Client, **fields: Any) -> None:
    """Add an entity to the map.

    Without --at, --on, --in and --next-to, it is placed at the next free position.
    """
    print_result(client.add(**drop_unset(fields)), lines.format_change)


@command(example="semmap update cup1 --at 2.5 1 0.75 --yaw 90deg")
@click.argument("name", shell_complete=entity_names)
@_describing
@click.option("--class", "class_", metavar="CLASS", shell_complete=class_names)
@click.option(
    "--conflict",
    metavar="TEXT",
    help="Store an observation that contradicts the map; an empty text clears it.",
)
@_set
@click.option(
    "--unset",
    multiple=True,
    metavar="PROPERTY[=VALUE]",
    help="Remove one value of a property, or all. With --set of the same property, replace them.",
)
@click.option("--force", is_flag=True, help="Allow an object to become a place, or a place an object.")
@carry_options
@_dry_run
@json_option
@with_client
def update(client: Client, **fields: Any) -> None:
    """Change an entity; omitted fields keep their values.

    NAME may also be the name or IRI of an individual that is not in space: then its class, its labels and its
    properties can be changed.
    """
    print_result(client.update(**drop_unset(fields)), lines.format_change)


@command("set", example="semmap set door1 isOpen true", cls=NegativeNumbers)
@click.argument("name", shell_complete=entity_names)
@click.argument("property", metavar="PROPERTY")
@click.argument("values", metavar="VALUE...", nargs=-1, required=True)
@_if_is
@click.option("--if-unset", is_flag=True, help="Only if the property has no value now.")
@click.option("--confidence", type=float, metavar="P", help="Confidence, 0 to 1.")
@_id
@_dry_run
@json_option
@with_client
def set_(client: Client, name: str, property: str, values: tuple[str, ...], **fields: Any) -> None:
    """Set a property of an entity.

    NAME may also be a label or class of only one entity, or the name or IRI of an individual that is not in
    space.

    The value of a functional property replaces the previous one. Other properties keep their previous values.
    The range of the property gives the datatype. A text ends with its language where the range allows one:
    Regal@de.
    """
    print_result(client.set(name, property, *values, **_drop_none(fields)), lines.format_change)


@command(example="semmap unset cup1 hasColor", cls=NegativeNumbers)
@click.argument("name", shell_complete=entity_names)
@click.argument("property", metavar="PROPERTY")
@click.argument("value", required=False)
@_if_is
@_id
@_dry_run
@json_option
@with_client
def unset(client: Client, **fields: Any) -> None:
    """Remove one value of a property of an entity, or all.

    NAME may also be a label or class of only one entity, or the name or IRI of an individual that is not in
    space.
    """
    print_result(client.unset(**_drop_none(fields)), lines.format_change)


@command(example="semmap rename cup1 breakfast_cup")
@click.argument("name", shell_complete=entity_names)
@click.argument("new")
@_id
@_dry_run
@json_option
@with_client
def rename(client: Client, **fields: Any) -> None:
    """Rename an entity, with all references to it.

    Its body in the scene gets the new name, too. The history of the new name includes earlier commits.
    NAME may also be the name or IRI of an individual that is not in space.
    """
    print_result(client.rename(**drop_unset(fields)), lines.format_change)


@command(example="semmap track robot1 --from stream")
@click.argument("name", shell_complete=entity_names)
@click.option(
    "--from",
    "from_",
    type=click.Choice(["stream", "sim"]),
    default="stream",
    show_default=True,
    help="Source of its pose: programs that publish it, or the simulator.",
)
@click.option("--off", is_flag=True, help="Stop tracking; the entity keeps its last pose.")
@_id
@_dry_run
@json_option
@with_client
def track(client: Client, **fields: Any) -> None:
    """Receive live poses of an entity on semmap/live/NAME.

    The newest pose is used and is not committed. When the entity stops, its pose is committed.
    """
    print_result(client.track(**drop_unset(fields)), lines.format_change)


@command(example="semmap remove cup1 cup2")
@click.argument("names", nargs=-1, required=True, shell_complete=entity_names)
@_dry_run
@json_option
@with_client
def remove(client: Client, names: tuple[str, ...], dry_run: bool) -> None:
    """Remove entities from the map and the scene.

    NAMES may also be names or IRIs of individuals that are not in space.
    """
    print_result(client.remove(*names, dry_run=dry_run), lines.format_change)


@command(example="semmap clear --dry-run")
@_dry_run
@json_option
@with_client
def clear(client: Client, dry_run: bool) -> None:
    """Remove all entities from the map and the scene."""
    from semmap.nodes.extern.cli.output.progress import progress

    with progress(client):
        reply = client.clear(dry_run=dry_run)
    print_result(reply, lines.format_change)


@command(example="semmap load demo/flat.ttl --replace")
@click.argument("file", type=click.Path())
@click.option("--replace", is_flag=True, help="Replace the current entities.")
@click.option("--add-only", is_flag=True, help="Reject files with other values for current entities.")
@click.option("--skip-unknown", is_flag=True, help="Skip entities of unknown classes.")
@click.option("--strict", is_flag=True, help="Reject files that refer to undescribed entities.")
@click.option(
    "--tbox", is_flag=True, help="FILE (or folder, or household) is a TBox that replaces the current one."
)
@click.option("--extend", is_flag=True, help="With --tbox: add FILE to the current TBox.")
@click.option(
    "--tbox-from-abox", is_flag=True, help="Add classes and properties of a map's file to the TBox."
)
@click.option("--parts", is_flag=True, help="Load in several commits, for files of any size.")
@click.option("--urdf", type=click.Path(), help="URDF file with poses of individuals named like its links.")
@click.option("--graph", metavar="NAME", default="", help="Load this named graph, not the default graph.")
@import_option
@spatial_root_option
@_dry_run
@json_option
@with_client
def load(client: Client, file: str, imports: tuple[tuple[str, Path], ...], **how: Any) -> None:
    """Load a map, a scene or a TBox from a file.

    A map is an ABox in any RDF or OWL syntax, a JSON scene or a HuRIC map. What it states about a current
    entity replaces its pose, size, labels and values of functional properties. A TBox is loaded with its
    imports. A plan is the .yaml file of an occupancy grid of the ROS map server: its free space becomes rooms
    and doors.
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
                f"{error.text}; {path.name} may or may not have been loaded; see: semmap history"
            ) from None
    plan = read_plan(path).lines if is_plan(path) and not how["tbox"] else ()
    print_result(reply, lambda reply: (*lines.format_change(reply), *(f"  {line}" for line in plan)))
