"""`semmap`: the command line. It does nothing that is not a command; watching is a subscription."""

from __future__ import annotations

import contextlib
import functools
import os
import shlex
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

from nodes import bus
from nodes.extern import show, sparql_cli, sparql_formats
from nodes.extern.client import CONNECT_VARIABLE, Client, connect, read_file
from nodes.extern.loading import progress
from nodes.extern.past_cli import history, last_seen, undo
from nodes.extern.system_cli import down, node, repair, up
from nodes.extern.talking import print_json, print_lines, talks
from schemas import codec, commands, errors, keys
from schemas.entities import Entity


class _Group(click.Group):
    """Names the nearest verbs when one is unknown."""

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        if args and self.get_command(ctx, args[0]) is None:
            hint = errors.did_you_mean(args[0], self.commands)
            raise click.UsageError(f"unknown verb '{args[0]}'{hint or '; see: semmap --help'}")
        return super().resolve_command(ctx, args)


@click.group(cls=_Group, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100})
@click.version_option(package_name="semmap")
def app() -> None:
    """A robot's semantic map: what there is, what it is called, where it stands, and what follows."""


def _options(*decorators: Callable[[Any], Any]) -> Callable[[Any], Any]:
    return lambda function: functools.reduce(lambda f, decorate: decorate(f), reversed(decorators), function)


_xyz = functools.partial(click.option, nargs=3, type=float)
_describing = _options(
    _xyz("--at", metavar="X Y Z", help="Bottom centre in the map frame [m]."),
    click.option("--yaw", type=float, metavar="RAD", help="Rotation about z."),
    click.option("--orientation", nargs=4, type=float, metavar="W X Y Z", help="Unit quaternion."),
    _xyz("--size", metavar="X Y Z", help="Extent along its own axes [m]."),
    click.option("--ref", metavar="TEXT", help="What people call it."),
    click.option("--alt", multiple=True, metavar="TEXT", help="What they call it too; may be repeated."),
    click.option("--wait", is_flag=True, help="Reply when its body stands in the scene."),
    click.option("--id", "id", metavar="ID", help="Command id: the same one twice is executed once."),
)
_format = functools.partial(click.option, "--format", "format")
_as_of = click.option(
    "--as-of", metavar="COMMIT|TIME", help="As it was after a commit, or at a time (ISO 8601)."
)


@app.command()
@click.argument("class_", metavar="CLASS")
@click.argument("name", required=False)
@_describing
@click.option("--default", is_flag=True, help="At the next free place, named and called after its class.")
@talks
def add(client: Client, **fields: Any) -> None:
    """Put an entity into the map."""
    print_lines(show.changed(client.add(**_given(fields))))


@app.command()
@click.argument("name")
@_describing
@click.option("--class", "class_", metavar="CLASS")
@talks
def update(client: Client, **fields: Any) -> None:
    """Change what is named; what is not named stays."""
    print_lines(show.changed(client.update(**_given(fields))))


@app.command()
@click.argument("names", nargs=-1, required=True)
@talks
def remove(client: Client, names: tuple[str, ...]) -> None:
    """Take entities out of map and scene."""
    print_lines(show.changed(client.remove(*names)))


@app.command()
@talks
def clear(client: Client) -> None:
    """Take every entity out of map and scene; the TBox stays."""
    print_lines(show.changed(client.clear()))


@app.command()
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


@app.command("list")
@click.option("--class", "class_", metavar="CLASS", help="Only those of this class, also by inference.")
@_format(type=click.Choice(["table", "json", "lu4r", "legacy"]), default="table", show_default=True)
@_as_of
@talks
def list_(client: Client, class_: str | None, format: str, as_of: str | None) -> None:
    """List the entities."""
    if format in ("lu4r", "legacy"):
        print_json(client.list_as(format, class_, as_of=as_of))  # type: ignore[arg-type]
        return
    entities = client.list(class_, as_of=as_of)
    if format == "json":
        print_json(entities)
        return
    _print_entities(entities)


@app.command()
@click.argument("name")
@_format(type=click.Choice(["table", "json"]), default="table", show_default=True)
@_as_of
@talks
def get(client: Client, name: str, format: str, as_of: str | None) -> None:
    """Show one entity."""
    entity = client.get(name, as_of=as_of)
    if format == "json":
        print_json(entity)
    else:
        show.console().print(show.entity_card(entity))


@app.command()
@click.option("--engine", type=click.Choice(["semmap", "owlrl"]), default="semmap", show_default=True)
@talks
def check(client: Client, engine: Any) -> None:
    """Is the map consistent, and if not, why?"""
    checked = client.check(engine)
    print(f"{checked.text} ({checked.engine}, {checked.triples} triples, {checked.elapsed_s:.3f} s)")
    if not checked.consistent:
        sys.exit(errors.Inconsistent.exit_status)


@app.command()
@click.argument("name", required=False)
@talks
def infer(client: Client, name: str | None) -> None:
    """What follows that was not said, about one entity or all."""
    print_lines(show.inferred(client.infer(name)))


@app.command()
@click.argument("name")
@click.argument("predicate")
@click.argument("value")
@talks
def explain(client: Client, name: str, predicate: str, value: str) -> None:
    """Why something holds: semmap explain fridge1 type Device."""
    print_lines(show.explanation(client.explain(name, predicate, value)))


@app.command()
@click.argument("file", type=click.Path(path_type=Path))
@_format(type=click.Choice(commands.RDF_FORMATS), help="Default: by the file's ending, else rdfxml.")
@click.option("--inferred", is_flag=True, help="With what follows.")
@talks
def export(client: Client, file: Path, format: Any, inferred: bool) -> None:
    """Write the map to FILE, checked first and all at once."""
    document = client.export(format or _format_of(file), inferred=inferred)
    _write_atomically(file, document.content)
    print(f"wrote {document.triples} triples to {file} (commit {document.seq})")


@app.command()
@_format(type=click.Choice(["tree", "json"]), default="tree", show_default=True)
@talks
def classes(client: Client, format: str) -> None:
    """The class tree, with the number of entities of each class."""
    if format == "json":
        print_json(client.classes())
    else:
        show.console().print(show.class_tree(client.classes()))


@app.command()
@_format(type=click.Choice(["table", "json"]), default="table", show_default=True)
@talks
def status(client: Client, format: str) -> None:
    """The nodes and the map."""
    status = client.status()
    if format == "json":
        print_json(status)
        return
    show.console().print(show.status_table(status))
    print(show.status_line(status))
    print_lines(f"  {problem}" for problem in status.problems)


@app.command()
@click.argument("name")
@_xyz("--at", metavar="X Y Z", required=True, help="Where the hand lets go: bottom centre [m].")
@click.option("--yaw", type=float, metavar="RAD")
@talks
def move(client: Client, name: str, at: Any, yaw: float | None) -> None:
    """Take a body and put it elsewhere, as a hand would; the map follows when it rests."""
    print(client.move(**_given({"name": name, "at": at, "yaw": yaw})).text)


@app.command()
@click.option("--off/--on", "off", default=None, help="Run or stop; without either, the other of the two.")
@talks
def pause(client: Client, off: bool | None) -> None:
    """Stop simulated time, or let it run again."""
    print(client.send(commands.Pause(off=off)).text)


@app.command()
@click.option("--seconds", type=float, default=0.1, show_default=True)
@talks
def step(client: Client, seconds: float) -> None:
    """Let paused time go on for a moment."""
    print(client.send(_command(commands.StepOnce, seconds=seconds)).text)


@app.command()
@talks
def reset(client: Client) -> None:
    """Put every body back where the map says."""
    print(client.send(commands.Reset()).text)


@app.command()
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--camera", metavar="NAME", help="A camera of the world; without one, all from aloft.")
@click.option("--width", type=int, default=960, show_default=True)
@click.option("--height", type=int, default=720, show_default=True)
@talks
def picture(client: Client, file: Path, camera: str | None, width: int, height: int) -> None:
    """Write a picture of the scene to FILE (PNG)."""
    if file.suffix.lower() != ".png":
        raise errors.BadRequest(f"pictures are PNG; call the file {file.with_suffix('.png').name}")
    _write_atomically(file, client.picture(camera, width=width, height=height))
    print(f"wrote {file}")


@app.command()
@click.argument("keyexpr", default=keys.COMMIT.key)
@click.option("--sparql", "query", metavar="QUERY", help="The rows of a SELECT instead, as they come and go.")
@click.option("--inferred", is_flag=True, help="With --sparql: over what follows, too.")
@talks
def watch(client: Client, keyexpr: str, query: str | None, inferred: bool) -> None:
    """Print what is published on a key expression, as it happens; without one, the commits."""
    if query is not None:
        sparql_cli.watch(client, query, inferred=inferred)
    if keyexpr == keys.COMMIT.key:
        with client.commits() as commits:
            for commit in commits:
                print(show.commit_line(commit), flush=True)
    for key, payload in bus.listen(client.session, keyexpr):
        print(f"{key}  {payload}", flush=True)


@app.command()
@click.argument("query")
@click.option("--inferred", is_flag=True, help="Over what follows, too.")
@_format(
    type=click.Choice(sparql_formats.FORMATS),
    help="Default: table for rows, else turtle.",
)
@click.option("--timeout", type=float, default=5.0, show_default=True, metavar="S", help="Cancelled after.")
@click.option("--limit", type=int, default=10_000, show_default=True, metavar="N", help="Refused beyond.")
@talks
def sparql(client: Client, query: str, **options: Any) -> None:
    """Answer a SPARQL 1.1 query that reads: SELECT, ASK, CONSTRUCT, DESCRIBE.

    QUERY is the query, @FILE or - for stdin. Known prefixes: dm: (TBox), : (ABox), rdf:, rdfs:, owl:, xsd:.
    """
    sparql_cli.ask(client, query, **options)


@app.command()
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--keep-going", is_flag=True, help="Go on after a request that fails.")
@click.option(
    "--connect",
    "where",
    envvar=CONNECT_VARIABLE,
    default=bus.DEFAULT_ENDPOINT,
    metavar="EP",
    show_default=True,
)
def run(file: Path, keep_going: bool, where: str) -> None:
    """Send a file of requests, one a line: words of this command line, or a JSON message with its verb."""
    lines = _decode_lines(file)
    failed = 0
    with connect(where, agent=f"run/{file.name}") as client:
        for number, line in lines:
            click.echo(f"{number}: {line}")
            status = _run_line(client, line)
            failed += status != 0
            if status and not keep_going:
                raise SystemExit(status)
    if failed:
        raise errors.Refused(f"{failed} of {len(lines)} requests failed")


@app.command()
@click.argument("file", type=click.Path(path_type=Path))
def replay(file: Path) -> None:
    """Open a recording in the Rerun viewer."""
    from nodes.recorder.replay import replay as open_viewer

    open_viewer(file)


for command in (history, last_seen, undo, up, down, node, repair):
    app.add_command(command)


def main() -> None:
    """Run the command line; exit with 0 done, 1 refused, 2 bad request, 3 no answer."""
    sys.exit(execute(sys.argv[1:]))


def execute(arguments: list[str], client: Client | None = None) -> int:
    """Run one command line and return its exit status; what is wrong goes to stderr in one line."""
    try:
        app.main(arguments, prog_name="semmap", standalone_mode=False, obj=client)
    except errors.SemmapError as error:
        _complain(error.text)
        return error.exit_status
    except click.exceptions.NoArgsIsHelpError as error:
        print(error.format_message())
    except click.ClickException as error:
        _complain(error.format_message())
        return 2
    except (click.Abort, KeyboardInterrupt):
        return 130
    except BrokenPipeError:
        sys.stderr.close()
        return 0
    except SystemExit as end:
        return int(end.code or 0)
    return 0


def _run_line(client: Client, line: str) -> int:
    if line.startswith("{"):
        return _execute_message(client, line.encode())
    try:
        return execute(shlex.split(line), client)
    except ValueError as error:
        _complain(f"cannot read the line: {error}")
        return 2


def _execute_message(client: Client, message: bytes) -> int:
    """Send one JSON message that names its verb, print the reply, and return the exit status."""
    try:
        said: dict[str, Any] = codec.decode(message, dict[str, Any])
        verb = str(said.get("verb", ""))
        if verb not in commands.COMMANDS:
            raise errors.UnknownVerb(f"unknown verb '{verb}'{errors.did_you_mean(verb, commands.COMMANDS)}")
        reply = client.send(codec.decode(message, commands.COMMANDS[verb]))
    except errors.SemmapError as error:
        _complain(error.text)
        return error.exit_status
    if isinstance(reply, commands.Changed):
        print_lines(show.changed(reply))
    else:
        print(getattr(reply, "text", None) or codec.encode_json(reply).decode())
    return 0


def _decode_lines(file: Path) -> list[tuple[int, str]]:
    """The requests of a file with their line numbers; empty lines and # comments are none."""
    try:
        lines = read_file(file).decode().splitlines()
    except UnicodeDecodeError:
        raise errors.BadFile(f"{file} is no text file") from None
    stripped = ((number, line.strip()) for number, line in enumerate(lines, start=1))
    return [(number, line) for number, line in stripped if line and not line.startswith("#")]


def _given(fields: dict[str, Any]) -> dict[str, Any]:
    """The options that were given."""
    return {name: value for name, value in fields.items() if value not in (None, (), False)}


def _command(kind: type[Any], **fields: Any) -> Any:
    return codec.convert(_given(fields), kind)


def _print_entities(entities: tuple[Entity, ...]) -> None:
    if entities:
        show.console().print(show.entity_table(entities))
    print(f"{len(entities)} {'entity' if len(entities) == 1 else 'entities'}")


def _format_of(file: Path) -> commands.RdfFormat:
    endings: dict[str, commands.RdfFormat] = {
        ".ttl": "turtle",
        ".nt": "ntriples",
        ".jsonld": "jsonld",
        ".json": "jsonld",
    }
    return endings.get(file.suffix.lower(), "rdfxml")


def _write_atomically(file: Path, content: bytes) -> None:
    """All of `content` under that name, or nothing. Raises BadFile."""
    try:
        with tempfile.NamedTemporaryFile(dir=file.resolve().parent, delete=False) as temporary:
            temporary.write(content)
            temporary.flush()
            os.fsync(temporary.fileno())
        Path(temporary.name).chmod(0o644)
        Path(temporary.name).replace(file)
    except OSError as error:
        with contextlib.suppress(OSError, UnboundLocalError):
            Path(temporary.name).unlink()
        raise errors.BadFile(f"{file} cannot be written: {error.strerror}") from None


def _complain(text: str) -> None:
    print(f"semmap: {text.removeprefix('malformed message: ')}", file=sys.stderr)
