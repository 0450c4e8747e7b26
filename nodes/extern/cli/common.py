"""What all verbs that talk to a running system share: the connection, errors, exit statuses."""

from __future__ import annotations

import functools
import os
import sys
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any, Final, TypeVar

import click

from semmap.nodes.extern.cli.output.printable import escaped_json, print_escaped
from semmap.schemas import errors
from semmap.schemas.endpoints import CONNECT_VARIABLE, DEFAULT_ENDPOINT, IDENTITY_VARIABLE, NAMESPACE_VARIABLE

if TYPE_CHECKING:
    from semmap.nodes.extern.client import Client

TIME = (
    "TIME is ISO 8601 like 2026-03-01T12:30:05, as history shows it, and denotes its written precision: that"
    " whole second, 12:30 the minute (of today, without a date), the date alone the day. Or seconds since"
    " 1970, or a stamp_ns of the JSON."
)
"""For the help of options that take a time."""

CONNECTION: Final = {"where": "--connect", "identity": "--identity", "namespace": "--namespace"}
"""The options that choose a system, by the names of their parameters."""
_CONNECTION: Final[dict[str, dict[str, str]]] = {
    "where": {
        "metavar": "EP",
        "help": f"Zenoh endpoint of the system. Default: {DEFAULT_ENDPOINT}, or the only one that runs here.",
        "envvar": CONNECT_VARIABLE,
    },
    "identity": {
        "metavar": "DIR/NAME",
        "help": "Client certificate for a secure system: DIR/NAME.crt with its key.",
        "envvar": IDENTITY_VARIABLE,
    },
    "namespace": {
        "metavar": "ROBOT",
        "help": "Name of the robot, if several can be reached there.",
        "envvar": NAMESPACE_VARIABLE,
    },
}


_F = TypeVar("_F", bound=Callable[..., Any])


class _ConnectionOption(click.Option):
    """An option that every command has: its help page has one line for all of these."""

    def get_help_record(self, ctx: click.Context) -> tuple[str, str] | None:
        if self.name != next(p.name for p in ctx.command.params if isinstance(p, _ConnectionOption)):
            return None
        present = [CONNECTION[p.name] for p in ctx.command.params if p.name in CONNECTION]
        return ", ".join(present), "Which system to use; see: semmap --help."


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
    """Add the connection options to `semmap` itself; it passes them on to the command that follows."""
    for name, option in reversed(CONNECTION.items()):
        about = _CONNECTION[name]
        text = f"{about['help']}  [env var: {about['envvar']}]"
        function = click.option(option, name, metavar=about["metavar"], help=text)(function)
    return function


robots_option = click.option(
    "--robots",
    metavar="GLOB",
    help="Ask all robots whose names match, such as '*' or arm*,lift1; EP may be several, with commas.",
)
"""Which robots are asked together."""


def with_client(function: Callable[..., None]) -> Callable[..., None]:
    """A verb that with_client to a running system: its first argument is a client."""

    @connect_option
    @identity_option
    @namespace_option
    @functools.wraps(function)
    def with_client(where: str | None, identity: str | None, namespace: str | None, **arguments: Any) -> None:
        if (shared := click.get_current_context().obj) is not None:
            function(shared, **arguments)
            return
        from semmap.nodes.extern.client import (
            connect,  # not needed for what only prints help or completes a word
        )

        # For one question a peer's shorter way saves less time than joining as one takes.
        joining = connect(where, agent=_agent(), identity=identity, namespace=namespace, mode="client")
        with joining as client:
            try:
                function(client, **arguments)
            except errors.NoAnswer as error:
                if not (others := _other_robots(where, identity, namespace)):
                    raise
                raise errors.NoAnswer(f"{error.text}; robots that are there: {', '.join(others)}") from None

    return with_client


def supports_robots(show: Callable[..., None]) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """A verb that, with `--robots`, several robots answer: `show(robots, **arguments)` is called then.

    It stands above `with_client`. Raises SystemExit with 3 when a robot did not answer, after the others did.
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
            said = click.get_current_context().get_parameter_source("namespace")
            if said is click.core.ParameterSource.COMMANDLINE:
                raise errors.BadRequest("give either --robots or --namespace")
            with connect_robots(robots, where, identity_=who, agent=_agent()) as found:
                show(found, **arguments)

        return with_robots

    return decorate


def _other_robots(where: str | None, identity: str | None, namespace: str | None) -> tuple[str, ...]:
    """The robots that can be asked where the one that is meant has no node."""
    from semmap.nodes.extern.fleet.robots import robot_names

    try:
        there = robot_names(where, identity)
    except errors.SemmapError:
        return ()
    return () if (namespace or "") in there else tuple(filter(None, there))


def _agent() -> str:
    return f"cli/{os.environ.get('USER', 'user')}"


def run_arguments(app: click.Command, words: list[str], client: Client | None = None, where: str = "") -> int:
    """Run a command line, over `client` if there is one; its exit status.

    Errors are one line on stderr, which says `where` first.
    """
    try:
        app.main(words, prog_name="semmap", standalone_mode=False, obj=client)
    except errors.SemmapError as error:
        print_error(f"{where}{_strip_prefix(error.text)}")
        return error.exit_status
    except click.exceptions.NoArgsIsHelpError as error:
        print(error.format_message())
    except click.NoSuchOption as error:
        print_error(f"{where}{_unknown_option(error)}")
        return 2
    except click.BadOptionUsage as error:
        print_error(f"{where}{_missing_values(error, app, words[0])}")
        return 2
    except click.ClickException as error:
        print_error(f"{where}{error.format_message()}")
        return 2
    except (click.Abort, KeyboardInterrupt):
        return 130
    except BrokenPipeError:
        sys.stderr.close()
        return 0
    except SystemExit as end:
        return int(end.code or 0)
    return 0


def print_json(message: Any) -> None:
    """A reply as JSON."""
    import json

    from semmap.schemas import codec

    text = json.dumps(json.loads(codec.encode_json(message)), indent=2, ensure_ascii=False)
    print(escaped_json(text))


def print_lines(lines: Iterable[str]) -> None:
    """A reply in words."""
    for line in lines:
        print_escaped(line)


class _Metres(click.ParamType[float]):
    """A number of metres, without a unit."""

    name = "metres"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        try:
            return float(value)
        except ValueError:
            self.fail(f"'{value}' is not a number; write metres without a unit, as in 0.76", param, ctx)


_METRES: Final = _Metres()


def vector_option(*names: str, **options: Any) -> Callable[[Any], Any]:
    """An option of three numbers [m]."""
    return click.option(*names, nargs=3, type=_METRES, **options)


def frame_option(what: str) -> Callable[[Any], Any]:
    """In which frame positions are given or told."""
    return click.option("--frame", metavar="NAME", help=f"{what}; see: semmap frames.")


def carry_options(function: Callable[..., None]) -> Callable[..., None]:
    """The options of a verb that moves a thing with what is on it."""
    leave = click.option(
        "--leave", multiple=True, metavar="NAME", help="With --carry: not this one; may be repeated."
    )
    carry = click.option("--carry", is_flag=True, help="Take along what stands on it or is inside it.")
    return carry(leave(function))


def drop_unset(fields: dict[str, Any]) -> dict[str, Any]:
    """The options that were given; 0 is a value, though it equals False."""
    return {
        name: value
        for name, value in fields.items()
        if value is not None and value is not False and value != ()
    }


def print_error(text: str) -> None:
    """What is wrong, in one line on stderr."""
    print_escaped(f"semmap: {' '.join(text.split())}", file=sys.stderr)


def _strip_prefix(text: str) -> str:
    """A user knows of no message."""
    return text.removeprefix("malformed message: ")


def _missing_values(error: click.BadOptionUsage, app: click.Command, verb: str) -> str:
    """What an option of several values takes that was given fewer; click does not say of which command."""
    command = app.get_command(click.Context(app), verb) if isinstance(app, click.Group) else app
    for option in command.params if command is not None else ():
        if option.nargs > 1 and error.option_name in option.opts:
            values = f"{error.option_name} {option.metavar}"
            return f"{error.option_name} takes {option.nargs} values, with spaces between: {values}"
    return error.format_message()


def _unknown_option(error: click.NoSuchOption) -> str:
    """Which option may have been meant: `--format json` for `--json`."""
    text = f"there is no option '{error.option_name}'"
    options = [p for p in error.ctx.command.params if isinstance(p, click.Option)] if error.ctx else []
    word = error.option_name.lstrip("-")
    for option in options:
        if isinstance(option.type, click.Choice) and word in option.type.choices:
            return f"{text}; did you mean {option.opts[0]} {word}?"
    names = [name for option in options for name in (*option.opts, *option.secondary_opts)]
    return text + (errors.did_you_mean(error.option_name, names) or "; see: --help")
