"""Verbs whose arguments may be negative numbers, such as `semmap set shelf1 mass -3`."""

from __future__ import annotations

import re
from collections.abc import Iterator

import click

_NUMBER = re.compile(r"-(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?(,-?[\d.]+)?")
"""A negative number, or a position that begins with one: `-1,2`."""


class NegativeNumbers(click.Command):
    """A verb that takes `-3` as a value, where click alone would look for an option of that name."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Parse the words of a command line; raises NoSuchOption for an unknown option."""
        options = args[: args.index("--")] if "--" in args else list(args)
        ctx.ignore_unknown_options = True
        rest = super().parse_args(ctx, args)
        for word in self._values(ctx):
            if word.startswith("-") and word in options and not _NUMBER.fullmatch(word):
                raise click.NoSuchOption(word.partition("=")[0], ctx=ctx)
        return rest

    def _values(self, ctx: click.Context) -> Iterator[str]:
        """The texts that were given as arguments rather than options."""
        for parameter in self.params:
            if isinstance(parameter, click.Argument) and parameter.name:
                given = ctx.params.get(parameter.name)
                for value in given if isinstance(given, tuple) else (given,):
                    if isinstance(value, str):
                        yield value
