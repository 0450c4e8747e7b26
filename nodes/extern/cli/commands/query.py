"""The commands that query: `list`, `get`, `check`, `infer`, `explain`, `sparql` and others, and `watch`."""

from __future__ import annotations

import functools
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import click

from semmap.nodes.extern.cli import output
from semmap.nodes.extern.cli.angles import from_pose
from semmap.nodes.extern.cli.command import NegativeNumbers, command
from semmap.nodes.extern.cli.commands import robots as of_robots
from semmap.nodes.extern.cli.commands import sparql_output
from semmap.nodes.extern.cli.common import (
    TIME,
    frame_option,
    json_option,
    print_error,
    print_event,
    print_json,
    print_lines,
    print_result,
    supports_robots,
    with_client,
)
from semmap.nodes.extern.cli.output import lines
from semmap.nodes.extern.cli.output.formats import FORMATS
from semmap.nodes.extern.cli.output.printable import print_escaped
from semmap.nodes.extern.cli.shell_completion import class_names, entity_names
from semmap.nodes.extern.files import read_file, write_atomically
from semmap.schemas import commands, errors, keys, roles

if TYPE_CHECKING:
    from semmap.nodes.extern.client import Client

_format = functools.partial(click.option, "--format", "format")
_as_of = click.option("--as-of", metavar="COMMIT|TIME", help=f"The map after a commit or at a time. {TIME}")
COLUMNS: Final = ("name", "class", "x", "y", "z", "yaw", "size", "label", "body")
"""The columns of `list`; the module of the table is imported only when it is printed."""
_STATUS_S = 20.0
"""Timeout of `status` [s]: it also reports a system that is too busy to reply."""


def _columns(ctx: click.Context, parameter: click.Parameter, value: str | None) -> tuple[str, ...]:
    """Return the columns in a list of names."""
    if value is None:
        return COLUMNS
    names = tuple(name.strip() for name in value.split(","))
    for name in names:
        if name not in COLUMNS:
            meant = errors.did_you_mean(name, COLUMNS) or f"; use some of {', '.join(COLUMNS)}"
            raise click.BadParameter(f"unknown column '{name}'{meant}", ctx, parameter)
    return names


@command("list", example="semmap list --class Cup --on table1")
@click.option(
    "--class",
    "class_",
    metavar="CLASS",
    shell_complete=class_names,
    help="Only entities of this class, including inferred types.",
)
@click.option(
    "--on", metavar="THING", shell_complete=entity_names, help="Only objects on it, directly or indirectly."
)
@click.option(
    "--in",
    "in_",
    metavar="PLACE",
    shell_complete=entity_names,
    help="Only objects in this place or container.",
)
@click.option(
    "--near",
    metavar="THING|X,Y,Z",
    shell_complete=entity_names,
    help="Only objects near it, or within M metres of a position.",
)
@click.option("--within", type=float, metavar="M", help="With --near: maximum distance [m].")
@click.option("--nearest", type=int, metavar="N", help="With --to: only the N nearest, nearest first.")
@click.option("--to", metavar="THING|X,Y,Z", shell_complete=entity_names, help="See --nearest.")
@frame_option("Frame of all positions, in the arguments and in the output. Default: map")
@click.option("--all", is_flag=True, help="Also individuals that are not in space, such as organisations.")
@_format(type=click.Choice(["table", "json", "lu4r", "legacy"]), default="table", show_default=True)
@click.option("--sort", type=click.Choice(COLUMNS), help="Sort by this column.")
@click.option("--limit", type=click.IntRange(min=1), metavar="N", help="Only the first N entities.")
@click.option("--columns", callback=_columns, metavar="NAME,...", help="Only these columns of the table.")
@_as_of
@supports_robots(of_robots.entities)
@with_client
def list_(
    client: Client,
    class_: str | None,
    format: Any,
    as_of: str | None,
    sort: str | None,
    limit: int | None,
    columns: tuple[str, ...],
    **where: Any,
) -> None:
    """List the entities.

    THING and PLACE are a name, a label or a class. X,Y,Z is a position [m].
    """
    if format in ("lu4r", "legacy"):
        print_json(client.send(commands.List(class_=class_, format=format, as_of=as_of, **where)))
        return
    found = client.list(class_, as_of=as_of, **where)
    if format == "json":
        print_json(output.show.sort_entities(found, sort)[:limit])
        return
    of_robots.print_entities(found, sort, limit, columns)
    if as_of is None:
        print_lines(_suppressed_notes(client, filter(None, (where["on"], where["in_"]))))


def _suppressed_notes(client: Client, names: Iterable[str]) -> Iterator[str]:
    """Yield a note for each of these entities that has suppressed facts, which the list does not include."""
    for name in names:
        try:
            suppressed = client.get(name, where=True).withheld
        except errors.UnknownName:  # a label or a class
            continue
        if suppressed:
            yield f"note: relations of {name} that contradict the map are suppressed; see: semmap check"


@command(example="semmap get cup1")
@click.argument("name", shell_complete=entity_names)
@_format(type=click.Choice(["table", "json"]), default="table", show_default=True)
@_as_of
@frame_option("Frame of the printed pose")
@supports_robots(of_robots.entity)
@with_client
def get(client: Client, name: str, format: str, as_of: str | None, frame: str | None) -> None:
    """Show one entity and its location.

    NAME may also be the name or IRI of an individual that is not in space, such as an organisation: then the
    output has what is asserted about it, and what refers to it.
    """
    entity = client.get(name, where=True, as_of=as_of, frame=frame)
    if format == "json":
        print_json(entity)
    else:
        labels = client.properties() if entity.properties else ()
        output.show.console().print(output.show.entity_card(entity, labels))


@command(example="semmap check")
@click.option("--engine", type=click.Choice(["semmap", "owlrl"]), default="semmap", show_default=True)
@click.option("--shapes", type=click.Path(path_type=Path), metavar="FILE", help="File with SHACL shapes.")
@json_option
@with_client
def check(client: Client, engine: Any, shapes: Path | None) -> None:
    """Check consistency and SHACL shapes; explain violations.

    The shapes are those of the TBox, of the map and of FILE. The exit status is 1 if the map is inconsistent
    or violates a shape, and if shapes were not evaluated.
    """
    content, filename = b"", ""
    if shapes is not None:
        content, filename = read_file(shapes, largest=commands.SHAPES_BYTES), shapes.name
    checked = client.check(engine, shapes=content, filename=filename)
    print_result(checked, lines.format_check)
    if not (checked.consistent and checked.conforms):
        sys.exit(errors.Inconsistent.exit_status)


@command(example="semmap infer cup1")
@click.argument("name", required=False, shell_complete=entity_names)
@json_option
@with_client
def infer(client: Client, name: str | None) -> None:
    """List the inferred facts of one entity, or of all."""
    print_result(client.infer(name), lines.format_inferred)


@command(example="semmap explain cup1 isLocatedIn kitchen1", cls=NegativeNumbers)
@click.argument("name", shell_complete=entity_names)
@click.argument("predicate")
@click.argument("value")
@click.option("--not", "negated", is_flag=True, help="Explain why the fact cannot hold.")
@_format(type=click.Choice(["text", "json"]), default="text", show_default=True)
@with_client
def explain(client: Client, name: str, predicate: str, value: str, negated: bool, format: str) -> None:
    """Explain why a fact holds or, with --not, cannot hold.

    PREDICATE is a property, or type, sameAs, differentFrom, subClassOf, equivalentClass, disjointWith. For
    example, semmap explain --not cup1 type Room explains why cup1 cannot be a room.
    """
    explanation = client.explain(name, predicate, value, negated=negated)
    if format == "json":
        print_json(explanation)
    else:
        print_lines(lines.format_explanation(explanation))


@command(example="semmap could milk1 isInside oven1", cls=NegativeNumbers)
@click.argument("name", shell_complete=entity_names)
@click.argument("predicate")
@click.argument("value")
@_format(type=click.Choice(["text", "json"]), default="text", show_default=True)
@with_client
def could(client: Client, name: str, predicate: str, value: str, format: str) -> None:
    """Test whether a statement is consistent with the map.

    PREDICATE is a property, or type, sameAs, differentFrom. The map is not changed. The exit status is 0 if
    the statement is possible. Otherwise it is 1, and the reason is printed.
    """
    reply = client.could(name, predicate, value)
    if format == "json":
        print_json(reply)
    else:
        print_escaped(reply.text)
    if not reply.possible:
        sys.exit(errors.Inconsistent.exit_status)


@command(example="semmap relations cup1 --from person1")
@click.argument("name", shell_complete=entity_names)
@click.argument("other", required=False, shell_complete=entity_names)
@click.option(
    "--from", "viewer", metavar="ENTITY", help="Viewer: also show left of, behind ... as seen from there."
)
@from_pose
@_format(type=click.Choice(["text", "json"]), default="text", show_default=True)
@_as_of
@with_client
def relations(client: Client, name: str, other: str | None, format: str, **fields: Any) -> None:
    """Show the computed spatial relations of an object.

    With OTHER, show only the relations to that entity, including those that do not hold.
    """
    found = client.relations(name=name, other=other, **fields)
    if format == "json":
        print_json(found)
    else:
        print_lines(list(lines.format_relations(found)) or [_no_relations(client, name)])


def _no_relations(client: Client, name: str) -> str:
    """Return the text for an entity without spatial relations."""
    try:
        is_place = client.get(name).place
    except errors.UnknownName:  # a label or a class
        is_place = False
    if is_place:
        return f"{name} is a place; to list its contents: semmap list --in {name}"
    return f"{name} has no spatial relations to other entities"


@command(example="semmap export map.ttl --inferred")
@click.argument("file", type=click.Path(path_type=Path))
@_format(type=click.Choice(commands.RDF_FORMATS), help="Default: by the suffix of FILE.")
@click.option("--inferred", is_flag=True, help="Include inferred facts.")
@_as_of
@with_client
def export(client: Client, file: Path, format: Any, inferred: bool, as_of: str | None) -> None:
    """Export the map to FILE, after a consistency check."""
    document = client.export(format or _format_of(file), inferred=inferred, as_of=as_of)
    write_atomically(file, document.content)
    print(f"wrote {document.triples} triples to {file} (commit {document.seq})")
    for note in document.notes:
        print_escaped(f"note: {note}", file=sys.stderr)


@command(example="semmap classes")
@_format(type=click.Choice(["tree", "json"]), default="tree", show_default=True)
@with_client
def classes(client: Client, format: str) -> None:
    """Show the class tree with the number of entities per class."""
    if format == "json":
        print_json(client.classes())
    else:
        output.show.console().print(output.show.class_tree(client.classes()))


@command(example="semmap properties --format json")
@_format(type=click.Choice(["table", "json"]), default="table", show_default=True)
@with_client
def properties(client: Client, format: str) -> None:
    """Show the properties that `set` accepts, with their ranges."""
    found = client.properties()
    if format == "json":
        print_json(found)
    else:
        output.show.console().print(output.show.property_table(found))


@command(example="semmap rules --format json")
@_format(type=click.Choice(["table", "json"]), default="table", show_default=True)
@with_client
def rules(client: Client, format: str) -> None:
    """List the SWRL rules of the TBox, with how often each holds."""
    found = client.rules()
    if format == "json":
        print_json(found)
    elif not found:
        print("the TBox has no SWRL rules")
    else:
        output.show.console().print(output.show.rule_table(found))
        if any(rule.at_least for rule in found):
            print_error(
                "note: counting stopped at the time limit, so the rules marked with ≥ may hold more often"
            )


@command(example="semmap status")
@_format(type=click.Choice(["table", "json"]), default="table", show_default=True)
@supports_robots(of_robots.status)
@with_client
def status(client: Client, format: str) -> None:
    """Show the state of the nodes, the map and the scene."""
    status = client.send(commands.Status(), timeout_s=_STATUS_S)
    if format == "json":
        print_json(status)
        return
    output.show.console().print(output.show.status_table(status))
    print(output.show.status_line(status))
    print_lines(f"  {line}" for line in (*status.displaced, *status.pending))
    print_lines(f"  {line}" for line in output.show.problem_lines(status))
    print_lines(output.show.status_notes(status))


@command(example='semmap sparql "SELECT ?cup { ?cup a dm:Cup }" --inferred')
@click.argument("query")
@click.option("--inferred", is_flag=True, help="Include inferred facts.")
@_format(
    type=click.Choice(FORMATS),
    help="Default: table for rows, turtle for graphs.",
)
@click.option(
    "--timeout",
    type=float,
    default=5.0,
    show_default=True,
    metavar="S",
    help="Cancel the query after S seconds.",
)
@click.option(
    "--limit",
    type=int,
    default=10_000,
    show_default=True,
    metavar="N",
    help="Reject results with more than N rows.",
)
@_as_of
@supports_robots(of_robots.rows)
@with_client
def sparql(client: Client, query: str, **options: Any) -> None:
    """Run a read-only SPARQL 1.1 query.

    QUERY is a SELECT, ASK, CONSTRUCT or DESCRIBE query, @FILE, or - for standard input. Predefined prefixes:
    dm: (TBox), : (ABox), rdf:, rdfs:, owl:, xsd:.
    """
    sparql_output.ask(client, query, **options)


@command(example="semmap watch --in kitchen1 --class Cup")
@click.argument("keyexpr", default=keys.COMMIT.key)
@click.option("--sparql", "query", metavar="QUERY", help="Watch the rows of a SELECT query instead.")
@click.option("--inferred", is_flag=True, help="With --sparql: include inferred facts.")
@click.option("--on", metavar="THING", shell_complete=entity_names, help="Watch the objects on it.")
@click.option(
    "--in", "in_", metavar="PLACE", shell_complete=entity_names, help="Watch the objects in or inside it."
)
@click.option("--near", metavar="THING", shell_complete=entity_names, help="Watch the objects near it.")
@click.option("--within", type=float, metavar="M", help="With --near: maximum distance [m].")
@click.option(
    "--class",
    "class_",
    metavar="CLASS",
    shell_complete=class_names,
    help="With --on, --in, --near: only objects of this class.",
)
@json_option
@with_client
def watch(client: Client, keyexpr: str, query: str | None, inferred: bool, **where: Any) -> None:
    """Print commits, or other messages, as they are published.

    KEYEXPR is a Zenoh key expression. THING and PLACE are a name, a label or a class, as for list. Objects
    and rows that appear are marked with +, those that disappear with -.
    """
    asks_where = any(word is not None for word in where.values())
    if (query is not None) + (keyexpr != keys.COMMIT.key) + asks_where > 1:
        raise errors.BadRequest(
            "KEYEXPR, --sparql, and --on/--in/--near exclude each other; use one of the three"
        )
    from semmap.nodes.extern import availability

    with availability.report_availability(client, print_error):
        if query is not None:
            sparql_output.watch(client, query, inferred=inferred)
        elif asks_where:
            sparql_output.watch_places(client, inferred=inferred, **where)
        else:
            _watch_key(client, keyexpr)


def _watch_key(client: Client, keyexpr: str) -> None:
    if sys.stderr.isatty():
        print(f"watching {keyexpr}; press Ctrl-C to stop", file=sys.stderr)
    if keyexpr == keys.COMMIT.key:
        with client.commits() as commits:
            for commit in commits:
                print_event(commit, [output.show.commit_line(commit)])
    from semmap.nodes import bus

    if client.identity is not None:
        role = client.identity.role
        if not bus.includes(roles.followed(role), keyexpr):
            raise errors.Refused(roles.not_subscribing(role, keyexpr))
    if not bus.intersects(keys.published(), keyexpr):
        print(
            f"note: semmap does not publish on '{keyexpr}', only other programs may; the keys of semmap are"
            f" '{keys.ROOT}/**'",
            file=sys.stderr,
        )
    for key, payload in bus.listen(client.session, keyexpr):
        print_event({"key": key, "payload": payload}, [f"{key}  {payload}"])


def _format_of(file: Path) -> commands.RdfFormat:
    endings: dict[str, commands.RdfFormat] = {
        ".ttl": "turtle",
        ".nt": "ntriples",
        ".jsonld": "jsonld",
        ".json": "jsonld",
        ".owl": "rdfxml",
        ".rdf": "rdfxml",
        ".xml": "rdfxml",
        ".ofn": "functional",
        ".fss": "functional",
        ".omn": "manchester",
    }
    if (known := endings.get(file.suffix.lower())) is None:
        raise errors.BadRequest(f"{file.name}: unknown suffix (known: {', '.join(endings)}); add --format")
    return known
