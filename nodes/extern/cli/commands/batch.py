"""The command `batch`: several changes, one per line, in one commit."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, Final, NoReturn

import click

from semmap.nodes.extern.cli import usage_errors
from semmap.nodes.extern.cli.command import command
from semmap.nodes.extern.cli.commands.edit import set_, unset, update
from semmap.nodes.extern.cli.common import json_option, print_result, with_client
from semmap.nodes.extern.cli.output import lines
from semmap.nodes.extern.client import Client
from semmap.nodes.extern.client_commands import CommandMethods
from semmap.nodes.extern.files import read_file
from semmap.schemas import codec, errors
from semmap.schemas.commands import Command, Set, Unset, Update

_COMMANDS: Final[dict[str, click.Command]] = {"update": update, "set": set_, "unset": unset}


@command(example='semmap batch changes.txt --reason "tidy up"')
@click.argument("file", type=click.Path(path_type=Path, allow_dash=True))
@click.option("--reason", default="", metavar="TEXT", help="Reason for the change, stored in the history.")
@click.option("--id", "id", default="", metavar="ID", help="Command id; a batch sent twice is executed once.")
@click.option("--dry-run", is_flag=True, help="Report what would change, without changing anything.")
@json_option
@with_client
def batch(client: Client, file: Path, **fields: Any) -> None:
    """Apply several changes in one commit, or none of them.

    FILE, or - for standard input, has one update, set or unset command per line, as on the command line:
    set door1 isOpen true. Empty lines and lines that begin with # are ignored. One undo reverts the batch.
    """
    content = sys.stdin.buffer.read() if str(file) == "-" else read_file(file)
    try:
        changes = tuple(read_changes(codec.decode_text(content)))
    except UnicodeDecodeError:
        raise errors.BadFile(f"{file} is not a UTF-8 text file") from None
    if not changes:
        raise errors.BadRequest(f"{file}: no changes found; write one update, set or unset command per line")
    print_result(client.batch(*changes, **fields), lines.format_change)


def read_changes(text: str) -> Iterator[Update | Set | Unset]:
    """Yield the changes in a text, one per line. Raises BadRequest with the number of the line."""
    for number, line in enumerate(text.splitlines(), start=1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        try:
            yield _change(shlex.split(line))
        except (ValueError, errors.SemmapError) as error:
            fault = str(error)
            raise errors.BadRequest(f"line {number}: {fault[:1].lower()}{fault[1:].rstrip('.')}") from None


def _change(words: list[str]) -> Update | Set | Unset:
    words = words[1:] if words[:1] == ["semmap"] else words
    if not words or words[0] not in _COMMANDS:
        raise errors.BadRequest(f"'{' '.join(words[:1])}' is not one of {', '.join(_COMMANDS)}")
    command = _COMMANDS[words[0]]
    try:
        with command.make_context(words[0], words[1:], obj=_Recorder()) as context:
            command.invoke(context)
    except _Recorded as recorded:
        return recorded.change
    except click.exceptions.Exit:
        pass
    except click.ClickException as error:
        raise errors.BadRequest(usage_errors.describe(error, command, words[0])) from None
    raise errors.BadRequest(f"'{words[0]} {' '.join(words[1:])}' is not a change")


class _Recorded(Exception):
    """The command that would have been sent."""

    def __init__(self, change: Any) -> None:
        self.change: Update | Set | Unset = change


class _Recorder(CommandMethods):
    """A client that raises the command instead of sending it."""

    def request(self, make: Callable[[], Command[Any]], read: object = None) -> NoReturn:
        """Raise `_Recorded` with the command."""
        raise _Recorded(make())
