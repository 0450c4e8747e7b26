"""The verb `batch`: changes that are written a line each, made in one commit."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, Final, NoReturn

import click

from semmap.nodes.extern.cli.command import command
from semmap.nodes.extern.cli.commands.edit import set_, unset, update
from semmap.nodes.extern.cli.common import print_lines, with_client
from semmap.nodes.extern.cli.output import lines
from semmap.nodes.extern.client import Client
from semmap.nodes.extern.client_commands import CommandMethods
from semmap.nodes.extern.files import read_file
from semmap.schemas import errors
from semmap.schemas.commands import Command, Set, Unset, Update

_VERBS: Final[dict[str, click.Command]] = {"update": update, "set": set_, "unset": unset}


@command(example='semmap batch changes.txt --reason "tidy up"')
@click.argument("file", type=click.Path(path_type=Path, allow_dash=True))
@click.option("--reason", default="", metavar="TEXT", help="Why, for the history.")
@click.option("--id", "id", default="", metavar="ID", help="Command id; a batch sent twice is executed once.")
@click.option("--dry-run", is_flag=True, help="Report what would change, without changing anything.")
@with_client
def batch(client: Client, file: Path, **fields: Any) -> None:
    """Make several changes in one commit, or none.

    FILE has one update, set or unset a line, as on the command line: set door1 isOpen true. Empty lines
    and those that begin with # do not count; - reads standard input. One undo takes all back.
    """
    content = sys.stdin.buffer.read() if str(file) == "-" else read_file(file)
    try:
        changes = tuple(written(content.decode()))
    except UnicodeDecodeError:
        raise errors.BadFile(f"{file} is no text in UTF-8") from None
    if not changes:
        raise errors.BadRequest("there is no change: write one update, set or unset a line")
    print_lines(lines.changed(client.batch(*changes, **fields)))


def written(text: str) -> Iterator[Update | Set | Unset]:
    """The changes that a text has, a line each. Raises BadRequest, which names the line."""
    for number, line in enumerate(text.splitlines(), start=1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        try:
            yield _change(shlex.split(line))
        except (ValueError, click.ClickException, errors.SemmapError) as error:
            said = error.format_message() if isinstance(error, click.ClickException) else str(error)
            raise errors.BadRequest(f"line {number}: {said[:1].lower()}{said[1:].rstrip('.')}") from None


def _change(words: list[str]) -> Update | Set | Unset:
    words = words[1:] if words[:1] == ["semmap"] else words
    if not words or words[0] not in _VERBS:
        raise errors.BadRequest(f"'{' '.join(words[:1])}' is none of {', '.join(_VERBS)}")
    verb = _VERBS[words[0]]
    try:
        with verb.make_context(words[0], words[1:], obj=_Writer()) as context:
            verb.invoke(context)
    except _Written as written:
        return written.change
    except click.exceptions.Exit:
        pass
    raise errors.BadRequest(f"'{words[0]} {' '.join(words[1:])}' is no change")


class _Written(Exception):
    """What a verb would have sent."""

    def __init__(self, change: Any) -> None:
        self.change: Update | Set | Unset = change


class _Writer(CommandMethods):
    """A client that sends nothing: it hands over what it was to send."""

    def request(self, make: Callable[[], Command[Any]], read: object = None) -> NoReturn:
        """Raises `_Written` with the command."""
        raise _Written(make())
