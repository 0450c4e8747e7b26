"""The classes of commands: each has an example, which its help page shows."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from typing import Any

import click

from semmap.nodes.extern.cli.usage_errors import unexpected_arguments

_NUMBER = re.compile(r"-(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?(,-?[\d.]+)?")
"""A negative number, or a position that begins with one: `-1,2`."""


class Command(click.Command):
    """A command whose help page ends with an example."""

    def __init__(self, *args: Any, example: str = "", **options: Any) -> None:
        super().__init__(*args, **options)
        self.example = example

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Parse the arguments of a command line. Raises UsageError for unexpected ones."""
        ctx.allow_extra_args = True
        rest = super().parse_args(ctx, args)
        if rest and not ctx.resilient_parsing:
            if unknown := [word for word in rest if word.startswith("--") and word in args]:
                raise click.NoSuchOption(unknown[0].partition("=")[0], ctx=ctx)
            raise click.UsageError(unexpected_arguments(ctx, rest), ctx)
        return rest

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the example below the options."""
        super().format_epilog(ctx, formatter)
        _write_example(self.example, formatter)


class CommandGroup(click.Group):
    """A command with subcommands; its help page ends with an example, too."""

    command_class = Command

    def __init__(self, *args: Any, example: str = "", **options: Any) -> None:
        super().__init__(*args, **options)
        self.example = example

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the example below the list of subcommands."""
        super().format_epilog(ctx, formatter)
        _write_example(self.example, formatter)


class NegativeNumbers(Command):
    """A command that accepts `-3` as an argument, where click alone would look for an option of that name."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Parse the arguments of a command line. Raises NoSuchOption for an unknown option."""
        options = args[: args.index("--")] if "--" in args else list(args)
        ctx.ignore_unknown_options = True
        rest = super().parse_args(ctx, args)
        for word in self._values(ctx):
            if word.startswith("-") and word in options and not _NUMBER.fullmatch(word):
                raise click.NoSuchOption(word.partition("=")[0], ctx=ctx)
        return rest

    def _values(self, ctx: click.Context) -> Iterator[str]:
        """Yield the texts that were passed as arguments, not as options."""
        for parameter in self.params:
            if isinstance(parameter, click.Argument) and parameter.name:
                found = ctx.params.get(parameter.name)
                for value in found if isinstance(found, tuple) else (found,):
                    if isinstance(value, str):
                        yield value


def command(
    name: str | None = None, *, example: str, cls: type[Command] = Command
) -> Callable[[Callable[..., Any]], Command]:
    """Make a command of a function; `example` is a command line that begins with `semmap COMMAND`."""
    return click.command(name, cls, example=example)


def group(*, example: str) -> Callable[[Callable[..., Any]], CommandGroup]:
    """Make a command with subcommands of a function; `example` is a command line."""
    return click.group(cls=CommandGroup, example=example)


def _write_example(example: str, formatter: click.HelpFormatter) -> None:
    if example:
        with formatter.section("Example"):
            formatter.write(f"{'':>{formatter.current_indent}}{example}\n")
