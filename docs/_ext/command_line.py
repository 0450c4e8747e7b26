"""Writes docs/command-line.md from the help of the command line (`make docs`); a test checks it."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import click

from semmap.nodes.extern.cli.all_verbs import app

PAGE = Path(__file__).parents[1] / "command-line.md"
HEAD = """# Command line

Written from `semmap --help`. Every verb takes `-h`; options may be given in any order.
"""


def page() -> str:
    """The page as it should be."""
    return HEAD + "".join(_sections(app, click.Context(app, info_name="semmap", **app.context_settings)))


def _sections(command: click.Command, context: click.Context) -> Iterator[str]:
    context.terminal_width = 78  # as wide as it is everywhere, whatever COLUMNS says
    level = context.command_path.count(" ") + 1
    heading = "" if level == 1 else f"\n{'#' * min(level, 3)} {context.command_path}\n"
    yield f"{heading}\n```text\n{command.get_help(context).rstrip()}\n```\n"
    if isinstance(command, click.Group):
        for name in command.list_commands(context):
            child = command.get_command(context, name)
            assert child is not None
            if not child.hidden:
                yield from _sections(
                    child, click.Context(child, parent=context, info_name=name, **child.context_settings)
                )


if __name__ == "__main__":
    PAGE.write_text(page())
