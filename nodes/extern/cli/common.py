"""Parts that the commands share: connection options, error messages and exit statuses."""

from __future__ import annotations

import functools
import os
import sys
from collections.abc import Callable, Iterable
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, Protocol, TypeVar

import click

from semmap.nodes.extern.cli import usage_errors
from semmap.nodes.extern.cli.output.printable import escaped_json, print_escaped
from semmap.nodes.extern.cli.shell_completion import entity_names
from semmap.schemas import errors
from semmap.schemas.endpoints import (
    CONNECT_VARIABLE,
    DEFAULT_ENDPOINT,
    IDENTITY_VARIABLE,
    NAMESPACE_VARIABLE,
    parse_endpoint,
)

if TYPE_CHECKING:
    from semmap.nodes.extern.client import Client

TIME = (
    "TIME is ISO 8601, as printed by history: 2026-03-01T12:30:05 (that second), 12:30 (that minute of today)"
    " or 2026-03-01 (that day); or in words: '5 minutes ago', 2h, yesterday, 'yesterday 10:00'."
    " Seconds since 1970 and stamp_ns values are also accepted."
)
"""The help of options that accept a time."""

CONNECTION: Final = {"where": "--connect", "identity": "--identity", "namespace": "--namespace"}
"""The options that choose a system, by the names of their parameters."""
_CONNECTION: Final[dict[str, dict[str, str]]] = {
    "where": {
        "metavar": "EP",
        "help": f"Zenoh endpoint of the system. Default: {DEFAULT_ENDPOINT}, or the only local system.",
        "envvar": CONNECT_VARIABLE,
    },
    "identity": {
        "metavar": "DIR/NAME",
        "help": "Client certificate for a secure system: DIR/NAME.crt and its key.",
        "envvar": IDENTITY_VARIABLE,
    },
    "namespace": {
        "metavar": "ROBOT",
        "help": "Name of the robot, if the endpoint reaches several.",
        "envvar": NAMESPACE_VARIABLE,
    },
}


_F = TypeVar("_F", bound=Callable[..., Any])
_T = TypeVar("_T")


class _ConnectionOption(click.Option):
    """A connection option. A help page lists all of them in one line."""

    def get_help_record(self, ctx: click.Context) -> tuple[str, str] | None:
        if self.name != next(p.name for p in ctx.command.params if isinstance(p, _ConnectionOption)):
            return None
        present = [CONNECTION[p.name] for p in ctx.command.params if p.name in CONNECTION]
        return ", ".join(present), "System to connect to; see: semmap --help."


def _connection_option(name: str) -> Callable[[_F], _F]:
    options = _CONNECTION[name]
    return click.option(
        CONNECTION[name],
        name,
        cls=_ConnectionOption,
        envvar=options["envvar"],
        metavar=options["metavar"],
        help=options["help"],
    )


connect_option = _connection_option("where")
identity_option = _connection_option("identity")
namespace_option = _connection_option("namespace")


def before_any_command(function: Callable[..., None]) -> Callable[..., None]:
    """Add the connection options to `semmap` itself, which forwards them to the command."""
    for name, option in reversed(CONNECTION.items()):
        about = _CONNECTION[name]
        text = f"{about['help']}  [env var: {about['envvar']}]"
        function = click.option(option, name, metavar=about["metavar"], help=text)(function)
    return function


robots_option = click.option(
    "--robots",
    metavar="GLOB",
    help="Query all robots whose names match, such as '*' or arm*,lift1; --connect accepts EP,EP.",
)


def with_client(function: Callable[..., None]) -> Callable[..., None]:
    """Decorate a command that needs a running system: its first argument becomes a client."""

    @connect_option
    @identity_option
    @namespace_option
    @functools.wraps(function)
    def connected(where: str | None, identity: str | None, namespace: str | None, **arguments: Any) -> None:
        if (shared := click.get_current_context().obj) is not None:
            function(shared, **arguments)
            return
        from semmap.nodes.extern.client import (
            connect,  # not needed for printing help and completing words
        )

        # Joining as a peer takes longer than one request gains by the direct link.
        joining = connect(where, agent=_agent(), identity=identity, namespace=namespace, mode="client")
        with joining as client:
            try:
                function(client, **arguments)
            except errors.NoAnswer as error:
                if not (others := other_robots(where, identity, namespace)):
                    raise
                raise errors.NoAnswer(f"{error.text}; available robots: {', '.join(others)}") from None

    return connected


def supports_robots(show: Callable[..., None]) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Add `--robots` to a command: with it, `show(robots, **arguments)` is called instead of the command.

    The decorator goes above `with_client`. Raises SystemExit with status 3 if a robot does not respond, after
    the replies of the others were printed.
    """

    def decorate(function: Callable[..., None]) -> Callable[..., None]:
        @robots_option
        @functools.wraps(function)
        def with_robots(robots: str | None, **arguments: Any) -> None:
            if robots is None:
                function(**arguments)
                return
            from semmap.nodes.extern.fleet.robots import robots as connect_robots

            where, who = arguments.pop("where"), arguments.pop("identity")
            arguments.pop("namespace")
            source = click.get_current_context().get_parameter_source("namespace")
            if source is click.core.ParameterSource.COMMANDLINE:
                raise errors.BadRequest("--robots and --namespace exclude each other; remove one of them")
            with connect_robots(robots, where, identity_=who, agent=_agent()) as found:
                show(found, **arguments)

        return with_robots

    return decorate


def other_robots(where: str | None, identity: str | None, namespace: str | None) -> tuple[str, ...]:
    """Return the other robots at the endpoint, if the robot `namespace` has no node there."""
    from semmap.nodes.extern.fleet.robots import robot_names

    try:
        there = robot_names(where, identity)
    except errors.SemmapError:
        return ()
    return () if (namespace or "") in there else tuple(filter(None, there))


def _agent() -> str:
    return f"cli/{os.environ.get('USER', 'user')}"


def run_arguments(app: click.Command, words: list[str], client: Client | None = None, where: str = "") -> int:
    """Run a command line, with `client` if there is one, and return its exit status.

    An error is printed to stderr in one line that begins with `where`. With `--format json` it is printed to
    stdout as `{"error": {"code": ..., "text": ...}}`.
    """
    report = _print_json_error if _wants_json(words) else _print_error
    try:
        app.main(words, prog_name="semmap", standalone_mode=False, obj=client)
    except errors.SemmapError as error:
        report(error.code, f"{where}{_strip_prefix(error.text)}")
        return error.exit_status
    except click.exceptions.NoArgsIsHelpError as error:
        print(error.format_message())
    except click.ClickException as error:
        report(_MISUSE, f"{where}{usage_errors.describe(error, app, ''.join(words[:1]))}")
        return 2
    except (click.Abort, KeyboardInterrupt):
        return 130
    except BrokenPipeError:
        sys.stderr.close()
        return 0
    except SystemExit as end:
        return int(end.code or 0)
    return 0


_MISUSE: Final = errors.BadRequest.code


def _wants_json(words: list[str]) -> bool:
    """Return whether a command line asks for JSON, even if it is not valid otherwise."""
    return "--format=json" in words or ("--format", "json") in pairwise(words)


def _print_json_error(code: str, text: str) -> None:
    print_json({"error": {"code": code, "text": text}})


def _print_error(_: str, text: str) -> None:
    print_error(text)


def print_json(message: Any) -> None:
    """Print a reply as JSON."""
    import json

    from semmap.schemas import codec

    text = json.dumps(json.loads(codec.encode_json(message)), indent=2, ensure_ascii=False)
    print(escaped_json(text))


def json_option(function: _F) -> _F:
    """Add `--format` to a command that prints its result with `print_result`."""
    return click.option(
        "--format",
        type=click.Choice(["text", "json"]),
        default="text",
        show_default=True,
        expose_value=False,
        callback=_set_format,
    )(function)


def _set_format(ctx: click.Context, _: click.Parameter, value: str) -> None:
    ctx.meta[_FORMAT] = value


_FORMAT: Final = "semmap.format"


def print_result(result: _T, lines: Callable[[_T], Iterable[str]]) -> None:
    """Print the result of a command with `json_option`: as JSON, or the lines of `lines(result)`."""
    if is_json():
        print_json(result)
    else:
        print_lines(lines(result))


def is_json() -> bool:
    """Return whether a command with `json_option` prints JSON."""
    return click.get_current_context().meta.get(_FORMAT) == "json"


def print_event(event: Any, lines: Iterable[str]) -> None:
    """Print one of many results as they occur: as one line of JSON, or `lines`."""
    if is_json():
        from semmap.schemas import codec

        print(escaped_json(codec.as_json(codec.encode(event))), flush=True)
    else:
        print_lines(lines)


def print_file(file: Path, text: str, **facts: Any) -> None:
    """Print the result of a command with `json_option` that wrote a file: its path and `facts`, or `text`."""
    print_result({"file": str(file), **facts}, lambda _: [text])


def print_text(reply: _WithText) -> None:
    """Print a reply that has a text, or the whole reply as JSON."""
    print_result(reply, lambda reply: [reply.text])


class _WithText(Protocol):
    @property
    def text(self) -> str: ...


def print_lines(lines: Iterable[str]) -> None:
    """Print the lines of a reply, and its notes to stderr."""
    for line in lines:
        print_escaped(line, file=sys.stderr if line.startswith("note: ") else None)


def print_count(text: str) -> None:
    """Print the last line of a table: to stderr if the table goes to a file or a pipe."""
    print_escaped(text, file=None if sys.stdout.isatty() else sys.stderr)


class _Metres(click.ParamType[float]):
    """A number of metres, without a unit."""

    name = "metres"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        try:
            return float(value)
        except ValueError:
            self.fail(f"'{value}' is not a number; use metres without a unit, as in 0.76", param, ctx)


_METRES: Final = _Metres()


def vector_option(*names: str, **options: Any) -> Callable[[Any], Any]:
    """Return an option with three numbers [m]."""
    return click.option(*names, nargs=3, type=_METRES, **options)


def frame_option(meaning: str) -> Callable[[Any], Any]:
    """Return the option that names the frame of positions."""
    return click.option("--frame", metavar="NAME", help=f"{meaning}; see: semmap frames.")


class Endpoint(click.ParamType[str]):
    """A Zenoh endpoint, also written `HOST:PORT` or `tcp://HOST:PORT`."""

    name = "endpoint"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> str:
        """Return the endpoint as Zenoh writes it."""
        try:
            return parse_endpoint(value)
        except errors.BadRequest as error:
            self.fail(error.text, param, ctx)


ENDPOINT: Final = Endpoint()


class InputPath(click.Path):
    """A file or folder that is read. A missing one is an error before anything else is done."""

    def __init__(self) -> None:
        super().__init__(path_type=Path)

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Return the path. Raises BadFile."""
        path = Path(value)
        try:
            path.stat()
        except (FileNotFoundError, NotADirectoryError):
            raise errors.BadFile(f"there is no file or folder {path}") from None
        except OSError as error:  # such as a name that is too long
            raise errors.BadFile(f"{path} cannot be read: {error.strerror}") from None
        return path


INPUT_PATH: Final = InputPath()


def placing_options(function: Callable[..., None]) -> Callable[..., None]:
    """Add the options that place an object relative to another one."""
    options = {
        "on": "Place it on this object, where there is room.",
        "in": "Place it in this object or place, where there is room.",
        "next-to": "Place it next to this object, where there is room.",
    }
    for name, text in reversed(options.items()):
        parameter = name.replace("-", "_") + ("_" if name == "in" else "")
        option = click.option(f"--{name}", parameter, metavar="NAME", shell_complete=entity_names, help=text)
        function = option(function)
    return function


def carry_options(function: Callable[..., None]) -> Callable[..., None]:
    """Add the options of a command that moves an object together with its contents."""
    leave = click.option(
        "--leave", multiple=True, metavar="NAME", help="With --carry: exclude this object; may be repeated."
    )
    carry = click.option("--carry", is_flag=True, help="Also move the objects on it and inside it.")
    return carry(leave(function))


def drop_unset(fields: dict[str, Any]) -> dict[str, Any]:
    """Return the options that were set. Zero is a value, although it equals False."""
    return {
        name: value
        for name, value in fields.items()
        if value is not None and value is not False and value != ()
    }


def print_error(text: str) -> None:
    """Print an error, a warning or a note to stderr in one line. Only errors begin with `semmap:`."""
    line = " ".join(text.split())
    print_escaped(line if line.startswith(("note: ", "warning: ")) else f"semmap: {line}", file=sys.stderr)


def _strip_prefix(text: str) -> str:
    """Remove the prefix of decoding errors: a user of the command line did not write a message."""
    return text.removeprefix("malformed message: ")
