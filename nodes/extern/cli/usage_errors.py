"""Error texts for a wrong use of the command line: one sentence with the next step."""

from __future__ import annotations

import re
import shlex
from collections.abc import Sequence
from typing import Any, Final

import click

from semmap.schemas import errors


def describe(error: click.ClickException, app: click.Command, name: str) -> str:
    """Return the error text for a wrong use of `app`, or of its command `name`."""
    if isinstance(error, click.NoSuchOption):
        return _unknown_option(error)
    if isinstance(error, click.BadOptionUsage):
        return _missing_values(error, app, name)
    if isinstance(error, click.MissingParameter):
        return _missing_parameter(error)
    return _one_line(error)


def _missing_values(error: click.BadOptionUsage, app: click.Command, name: str) -> str:
    """Return the error text for an option with too few values. Click does not report the command."""
    command = app.get_command(click.Context(app), name) if isinstance(app, click.Group) else app
    for option in command.params if command is not None else ():
        if option.nargs > 1 and error.option_name in option.opts:
            values = f"{error.option_name} {option.metavar}"
            return f"{error.option_name} requires {option.nargs} values, separated by spaces: {values}"
    return _one_line(error)


def _choices_of(choice: click.Choice[Any]) -> str:
    return ", ".join(map(str, choice.choices))


def _missing_parameter(error: click.MissingParameter) -> str:
    """Return the error text for a missing argument or option, with the next step."""
    parameter, ctx = error.param, error.ctx
    if parameter is None or ctx is None:
        return _one_line(error)
    if isinstance(parameter, click.Option):
        if isinstance(parameter.type, click.Choice):
            return f"missing option {parameter.opts[0]}; choose from: {_choices_of(parameter.type)}"
        option = " ".join(filter(None, (parameter.opts[0], parameter.metavar)))
        return f"missing option {option}; see: {ctx.command_path} --help"
    name = parameter.human_readable_name.removesuffix("...")
    if isinstance(parameter.type, click.Choice):
        return f"missing argument {name}; choose from: {_choices_of(parameter.type)}"
    return f"missing argument {name}; {_usage(ctx)}"


def unexpected_arguments(ctx: click.Context, rest: Sequence[str]) -> str:
    """Return the error text for arguments that a command does not have, with what was probably meant."""
    given = f"unexpected argument{'s' if len(rest) > 1 else ''} {' '.join(map(repr, rest))}"
    options = {name for p in ctx.command.params if isinstance(p, click.Option) for name in p.opts}
    arguments = [p for p in ctx.command.params if isinstance(p, click.Argument)]
    if "--at" in options and len(rest) == _AXES and all(map(_is_number, rest)):
        return f"{given}; did you mean --at {' '.join(rest)}?"
    if "--class" in options and not arguments and len(rest) == 1:
        return f"{given}; did you mean --class {rest[0]}?"
    if (
        arguments
        and arguments[-1].name in _TEXTS
        and isinstance(first := ctx.params[arguments[-1].name], str)
    ):
        text = shlex.quote(" ".join((first, *rest)))
        return f"{given}; a text with spaces must be quoted: {ctx.command_path} {text}"
    return f"{given}; a value with spaces must be quoted; {_usage(ctx)}"


_AXES: Final = 3
_TEXTS: Final = ("text", "query")
"""The names of arguments that are sentences or queries."""


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


def _usage(ctx: click.Context) -> str:
    formatter = click.HelpFormatter(width=1000)
    ctx.command.format_usage(ctx, formatter)
    return f"usage: {formatter.getvalue().strip().removeprefix('Usage: ')}"


_OPTIONAL: Final = re.compile(r"'\[([A-Z_]+)\]'")
"""An optional argument as click prints it: '[COMMIT]'."""
_NUMBERS: Final = (
    (re.compile(r"is not a valid integer(?: range)?"), "is not a whole number"),
    (re.compile(r"is not a valid float(?: range)?"), "is not a number"),
)


def _one_line(error: click.ClickException) -> str:
    """Return the message of an error of click without its capital letter, full stop and brackets of names."""
    text = _OPTIONAL.sub(r"\1", error.format_message())
    for kind, words in _NUMBERS:
        text = kind.sub(words, text)
    return f"{text[:1].lower()}{text[1:]}".rstrip(".")


_OPTION_SYNONYMS: Final = {
    "-n": "--limit", "--last": "--limit", "--count": "--limit", "--max": "--limit", "--top": "--limit",
    "--position": "--at", "--pos": "--at", "--pose": "--at", "--to": "--at", "--endpoint": "--connect",
    "--label": "--ref", "--alias": "--alt", "--port": "--web-port", "-v": "--version",
}  # fmt: skip
"""Option names of other tools, and the options that correspond to them."""


def _unknown_option(error: click.NoSuchOption) -> str:
    """Return the error text for an unknown option, with a suggestion: `--format json` for `--json`."""
    text = f"unknown option '{error.option_name}'"
    options = [p for p in error.ctx.command.params if isinstance(p, click.Option)] if error.ctx else []
    word = error.option_name.lstrip("-")
    for option in options:
        if _OPTION_SYNONYMS.get(error.option_name) in option.opts:
            return f"{text}; did you mean {option.opts[0]}?"
        if isinstance(option.type, click.Choice) and word in option.type.choices:
            return f"{text}; did you mean {option.opts[0]} {word}?"
    names = [name for option in options for name in (*option.opts, *option.secondary_opts)]
    path = error.ctx.command_path if error.ctx else "semmap"
    return text + (errors.did_you_mean(error.option_name, names) or f"; see: {path} --help")
