"""Writes docs/command-line.md from the help of the command line (`make docs`); a test checks it."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import click

from semmap.nodes.extern.cli.all_commands import app

PAGE = Path(__file__).parents[1] / "command-line.md"
HEAD = """# Command line

Generated from `semmap --help`. Every command has a help page: `semmap help COMMAND`.
Options may be given in any order.

Positions are in metres in the map frame, z up, at the bottom centre of an object; angles are in radians.

| exit status | meaning |
| --- | --- |
| 0 | success |
| 1 | rejected: it contradicts the map, a name is unknown or taken, or your role does not permit it |
| 2 | invalid usage: an unknown command or class, a malformed value or file |
| 3 | no response from the system |

Errors are one line on stderr. A failed command changes nothing.
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
    if "--print" in sys.argv:
        sys.stdout.write(page())
    else:
        PAGE.write_text(page())
