"""The verbs that query: `list`, `get`, `check`, `infer`, `explain`, `sparql` and others, and `watch`."""

from __future__ import annotations

import functools
import sys
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from semmap.nodes.extern.cli import output
from semmap.nodes.extern.cli.angles import from_pose
from semmap.nodes.extern.cli.calling import (
    TIME,
    answered_by_robots,
    complain,
    frame_option,
    print_json,
    print_lines,
    talks,
)
from semmap.nodes.extern.cli.completing import class_names, entity_names
from semmap.nodes.extern.cli.negative_numbers import NegativeNumbers
from semmap.nodes.extern.cli.output import lines
from semmap.nodes.extern.cli.output.formats import FORMATS
from semmap.nodes.extern.cli.output.printable import say
from semmap.nodes.extern.cli.verbs import robots as of_robots
from semmap.nodes.extern.cli.verbs import sparql as sparql_answers
from semmap.nodes.extern.files import write_atomically
from semmap.schemas import commands, errors, keys, roles
from semmap.schemas.entities import Entity

if TYPE_CHECKING:
    from semmap.nodes.extern.client import Client

_format = functools.partial(click.option, "--format", "format")
_as_of = click.option("--as-of", metavar="COMMIT|TIME", help=f"The map after a commit or at a time. {TIME}")
_STATUS_S = 20.0
"""Seconds: whoever asks how things stand is told of a system that is too busy to say."""


@click.command("list")
@click.option(
    "--class",
    "class_",
    metavar="CLASS",
    shell_complete=class_names,
    help="Only entities of this class, inferred types included.",
)
@click.option(
    "--on", metavar="THING", shell_complete=entity_names, help="Only what stands on it, or on what is on it."
)
@click.option(
    "--in",
    "in_",
    metavar="PLACE",
    shell_complete=entity_names,
    help="Only what is in that place, or inside that container.",
)
@click.option(
    "--near",
    metavar="THING|X,Y,Z",
    shell_complete=entity_names,
    help="Only what is near it, or within M of a position.",
)
@click.option("--within", type=float, metavar="M", help="With --near: maximum distance [m].")
@click.option("--nearest", type=int, metavar="N", help="With --to: only the N nearest, nearest first.")
@click.option("--to", metavar="THING|X,Y,Z", shell_complete=entity_names, help="See --nearest.")
@frame_option("The frame of positions, of those that are listed too, instead of the map's")
@_format(type=click.Choice(["table", "json", "lu4r", "legacy"]), default="table", show_default=True)
@_as_of
@answered_by_robots(of_robots.entities)
@talks
def list_(client: Client, class_: str | None, format: Any, as_of: str | None, **where: Any) -> None:
    """List the entities.

    THING and PLACE are a name, a reference or a class; X,Y,Z is a position [m].
    """
    if format in ("lu4r", "legacy"):
        print_json(client.send(commands.List(class_=class_, format=format, as_of=as_of, **where)))
        return
    entities = client.list(class_, as_of=as_of, **where)
    if format == "json":
        print_json(entities)
        return
    _print_entities(entities)
    if as_of is None:
        print_lines(_left_out(client, filter(None, (where["on"], where["in_"]))))


def _left_out(client: Client, words: Iterable[str]) -> Iterator[str]:
    """A note for each thing of that name about which something measured is withheld, and so is not listed."""
    for word in words:
        try:
            withheld = client.get(word, where=True).withheld
        except errors.UnknownName:  # a reference or a class
            continue
        if withheld:
            yield f"  note: not listed is what would contradict the map, about {word}; semmap check tells why"


@click.command()
@click.argument("name", shell_complete=entity_names)
@_format(type=click.Choice(["table", "json"]), default="table", show_default=True)
@_as_of
@frame_option("Tell its pose in this frame")
@answered_by_robots(of_robots.entity)
@talks
def get(client: Client, name: str, format: str, as_of: str | None, frame: str | None) -> None:
    """Show one entity, and where it is."""
    entity = client.get(name, where=True, as_of=as_of, frame=frame)
    if format == "json":
        print_json(entity)
    else:
        labels = client.properties() if entity.properties else ()
        output.show.console().print(output.show.entity_card(entity, labels))


@click.command()
@click.option("--engine", type=click.Choice(["semmap", "owlrl"]), default="semmap", show_default=True)
@talks
def check(client: Client, engine: Any) -> None:
    """Check whether the map is consistent, and explain why not."""
    checked = client.check(engine)
    say(f"{checked.text} ({checked.engine}, {checked.triples} triples, {checked.elapsed_s:.3f} s)")
    print_lines(f"  note: {relation.text}" for relation in checked.denied)
    print_lines(f"  note: {text}" for text in (*checked.withheld, *checked.crowds))
    if not checked.consistent:
        sys.exit(errors.Inconsistent.exit_status)


@click.command()
@click.argument("name", required=False, shell_complete=entity_names)
@talks
def infer(client: Client, name: str | None) -> None:
    """List the inferred facts about one entity, or about all."""
    print_lines(lines.inferred(client.infer(name)))


@click.command(cls=NegativeNumbers)
@click.argument("name", shell_complete=entity_names)
@click.argument("predicate")
@click.argument("value")
@click.option("--not", "negated", is_flag=True, help="Why it cannot hold.")
@_format(type=click.Choice(["text", "json"]), default="text", show_default=True)
@talks
def explain(client: Client, name: str, predicate: str, value: str, negated: bool, format: str) -> None:
    """Explain why a fact holds: semmap explain cup1 type Object.

    PREDICATE is a property, or type, sameAs, differentFrom, subClassOf, equivalentClass, disjointWith. With
    --not, why it cannot hold: semmap explain --not cup1 type Room.
    """
    explanation = client.explain(name, predicate, value, negated=negated)
    if format == "json":
        print_json(explanation)
    else:
        print_lines(lines.explanation(explanation))


@click.command(cls=NegativeNumbers)
@click.argument("name", shell_complete=entity_names)
@click.argument("predicate")
@click.argument("value")
@_format(type=click.Choice(["text", "json"]), default="text", show_default=True)
@talks
def could(client: Client, name: str, predicate: str, value: str, format: str) -> None:
    """Could something hold without contradicting the map?

    For example: semmap could milk1 isInside oven1. PREDICATE is a property, or type, sameAs, differentFrom.
    Nothing is changed. The exit status is 0 if it could, and 1 if it could not; then the answer says why.
    """
    answer = client.could(name, predicate, value)
    if format == "json":
        print_json(answer)
    else:
        say(answer.text)
    if not answer.possible:
        sys.exit(errors.Inconsistent.exit_status)


@click.command()
@click.argument("name", shell_complete=entity_names)
@click.argument("other", required=False, shell_complete=entity_names)
@click.option("--from", "viewer", metavar="ENTITY", help="Also left of, behind ... as seen from there.")
@from_pose
@_format(type=click.Choice(["text", "json"]), default="text", show_default=True)
@_as_of
@talks
def relations(client: Client, name: str, other: str | None, format: str, **fields: Any) -> None:
    """Show where a thing is relative to others, as measured.

    With OTHER only relative to that, and also what does not hold.
    """
    found = client.relations(name=name, other=other, **fields)
    if format == "json":
        print_json(found)
    else:
        print_lines(list(lines.relations(found)) or [_beside_nothing(client, name)])


def _beside_nothing(client: Client, name: str) -> str:
    """What is said of a thing that is in no relation to any other."""
    try:
        is_place = client.get(name).place
    except errors.UnknownName:  # a reference or a class
        is_place = False
    if is_place:
        return f"{name} is a place; what is in it tells: semmap list --in {name}"
    return f"{name} is on, in and near nothing"


@click.command()
@click.argument("file", type=click.Path(path_type=Path))
@_format(type=click.Choice(commands.RDF_FORMATS), help="Default: by the file's suffix, else rdfxml.")
@click.option("--inferred", is_flag=True, help="Include inferred facts.")
@_as_of
@talks
def export(client: Client, file: Path, format: Any, inferred: bool, as_of: str | None) -> None:
    """Export the map to FILE, checked for consistency first."""
    document = client.export(format or _format_of(file), inferred=inferred, as_of=as_of)
    write_atomically(file, document.content)
    print(f"wrote {document.triples} triples to {file} (commit {document.seq})")


@click.command()
@_format(type=click.Choice(["tree", "json"]), default="tree", show_default=True)
@talks
def classes(client: Client, format: str) -> None:
    """Show the class tree, with numbers of entities."""
    if format == "json":
        print_json(client.classes())
    else:
        output.show.console().print(output.show.class_tree(client.classes()))


@click.command()
@_format(type=click.Choice(["table", "json"]), default="table", show_default=True)
@talks
def properties(client: Client, format: str) -> None:
    """Show the properties that `set` may state, with their ranges."""
    found = client.properties()
    if format == "json":
        print_json(found)
    else:
        output.show.console().print(output.show.property_table(found))


@click.command()
@_format(type=click.Choice(["table", "json"]), default="table", show_default=True)
@answered_by_robots(of_robots.status)
@talks
def status(client: Client, format: str) -> None:
    """Show the state of the nodes, the map and the scene."""
    status = client.send(commands.Status(), timeout_s=_STATUS_S)
    if format == "json":
        print_json(status)
        return
    output.show.console().print(output.show.status_table(status))
    print(output.show.status_line(status))
    print_lines(f"  {line}" for line in (*status.displaced, *status.pending, *status.problems))
    print_lines(output.show.status_notes(status))


@click.command()
@click.argument("query")
@click.option("--inferred", is_flag=True, help="Query inferred facts, too.")
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
    help="Refuse results of more than N rows.",
)
@_as_of
@answered_by_robots(of_robots.rows)
@talks
def sparql(client: Client, query: str, **options: Any) -> None:
    """Run a read-only SPARQL 1.1 query.

    It is a SELECT, ASK, CONSTRUCT or DESCRIBE. QUERY is the query text, @FILE, or - for stdin. Predefined
    prefixes: dm: (TBox), : (ABox), rdf:, rdfs:, owl:, xsd:.
    """
    sparql_answers.ask(client, query, **options)


@click.command()
@click.argument("keyexpr", default=keys.COMMIT.key)
@click.option("--sparql", "query", metavar="QUERY", help="Watch the rows of a SELECT query instead.")
@click.option("--inferred", is_flag=True, help="With --sparql: query inferred facts, too.")
@click.option("--on", metavar="THING", shell_complete=entity_names, help="Watch what comes to be on it.")
@click.option("--in", "in_", metavar="PLACE", shell_complete=entity_names, help="... in it, or inside it.")
@click.option("--near", metavar="THING", shell_complete=entity_names, help="... near it.")
@click.option("--within", type=float, metavar="M", help="With --near: maximum distance [m].")
@click.option(
    "--class", "class_", metavar="CLASS", shell_complete=class_names, help="With these: only this class."
)
@talks
def watch(client: Client, keyexpr: str, query: str | None, inferred: bool, **where: Any) -> None:
    """Print the commits, or other messages, as they are published.

    KEYEXPR is a Zenoh key expression. THING and PLACE are a name, a reference or a class, as for list; what
    comes (+) and goes (-) is told.
    """
    asks_where = any(word is not None for word in where.values())
    if (query is not None) + (keyexpr != keys.COMMIT.key) + asks_where > 1:
        raise errors.BadRequest("give one of: a key expression, --sparql, or --on, --in and --near")
    from semmap.nodes.extern import availability

    with availability.told(client, complain):
        if query is not None:
            sparql_answers.watch(client, query, inferred=inferred)
        elif asks_where:
            sparql_answers.watch_places(client, inferred=inferred, **where)
        else:
            _watch_key(client, keyexpr)


def _watch_key(client: Client, keyexpr: str) -> None:
    if sys.stderr.isatty():
        print(f"watching {keyexpr}; Ctrl-C ends it", file=sys.stderr)
    if keyexpr == keys.COMMIT.key:
        with client.commits() as commits:
            for commit in commits:
                say(output.show.commit_line(commit))
    from semmap.nodes import bus

    if client.identity is not None:
        followed = roles.followed(client.identity.role)
        if not bus.includes(followed, keyexpr):
            raise errors.Refused(
                f"your certificate ({client.identity.role}) may not follow '{keyexpr}'; it may follow all of:"
                f" {', '.join(followed)}"
            )
    if not bus.intersects(keys.published(), keyexpr):
        print(
            f"  note: semmap publishes nothing on '{keyexpr}', so this waits for somebody else to;"
            f" all that it publishes is on '{keys.ROOT}/**'",
            file=sys.stderr,
        )
    for key, payload in bus.listen(client.session, keyexpr):
        say(f"{key}  {payload}")


def _print_entities(entities: Sequence[Entity]) -> None:
    if entities:
        output.show.console().print(output.show.entity_table(entities))
    print(output.show.entity_line(entities))


def _format_of(file: Path) -> commands.RdfFormat:
    endings: dict[str, commands.RdfFormat] = {
        ".ttl": "turtle",
        ".nt": "ntriples",
        ".jsonld": "jsonld",
        ".json": "jsonld",
        ".owl": "rdfxml",
        ".rdf": "rdfxml",
        ".xml": "rdfxml",
    }
    if (known := endings.get(file.suffix.lower())) is None:
        raise errors.BadRequest(
            f"cannot tell the format of {file.name} by its suffix ({', '.join(endings)}); use --format"
        )
    return known
