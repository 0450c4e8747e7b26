"""The command `run`: a file of requests, one per line."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Any

import click

from semmap.nodes.extern.cli.command import command
from semmap.nodes.extern.cli.common import (
    connect_option,
    identity_option,
    namespace_option,
    print_error,
    print_lines,
    run_arguments,
)
from semmap.nodes.extern.cli.output import lines
from semmap.nodes.extern.cli.output.printable import print_escaped
from semmap.nodes.extern.client import Client, connect
from semmap.nodes.extern.files import read_file
from semmap.schemas import codec, commands, errors, replies

_EXCLUDED = frozenset(
    ("up", "down", "node", "repair", "restore", "replay", "movie", "run", "watch", "completion")
)


@command(example="semmap run requests.txt --keep-going")
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--keep-going", is_flag=True, help="Continue after a failed request.")
@connect_option
@identity_option
@namespace_option
def run(file: Path, keep_going: bool, where: str | None, identity: str | None, namespace: str | None) -> None:
    """Execute a file of requests, one per line.

    A request is a command line, or a JSON message with the command in its field verb.
    """
    lines = _decode_lines(file)
    failed = 0
    with connect(where, agent=f"run/{file.name}", identity=identity, namespace=namespace) as client:
        for number, line in lines:
            print_escaped(f"{number}: {line}")
            status = _run_line(client, line.removeprefix("semmap "), f"line {number}: ")
            failed += status != 0
            if status and not keep_going:
                raise SystemExit(status)
    if failed:
        raise errors.Refused(f"{failed} of {len(lines)} requests failed")


def _run_line(client: Client, line: str, where: str) -> int:
    if line.startswith("{"):
        return _execute_message(client, line.encode(), where)
    try:
        words = shlex.split(line)
    except ValueError as error:
        print_error(f"{where}cannot read the line: {error}")
        return errors.BadRequest.exit_status
    if words and words[0] in _EXCLUDED:
        print_error(f"{where}'{words[0]}' cannot be used in a file of requests")
        return errors.BadRequest.exit_status
    return run_arguments(click.get_current_context().find_root().command, words, client, where)


def _execute_message(client: Client, message: bytes, where: str) -> int:
    """Send a JSON message with a field `verb`, print the reply, and return the exit status."""
    try:
        fields: dict[str, Any] = codec.decode(message, dict[str, Any])
        name = str(fields.get("verb", ""))
        if name not in commands.COMMANDS:
            raise errors.UnknownVerb(
                f"unknown command '{name}'{errors.did_you_mean(name, commands.COMMANDS)}"
            )
        reply: Any = client.send(codec.decode(message, commands.COMMANDS[name]))
    except errors.SemmapError as error:
        print_error(f"{where}{error.text.removeprefix('malformed message: ')}")
        return error.exit_status
    if isinstance(reply, replies.Changed):
        print_lines(lines.format_change(reply))
    else:
        print(getattr(reply, "text", None) or codec.encode_json(reply).decode())
    return 0


def _decode_lines(file: Path) -> list[tuple[int, str]]:
    """Return the requests of a file with their line numbers, without empty lines and # comments."""
    try:
        lines = codec.decode_text(read_file(file)).splitlines()
    except UnicodeDecodeError:
        raise errors.BadFile(f"{file} is not a UTF-8 text file") from None
    stripped = ((number, line.strip()) for number, line in enumerate(lines, start=1))
    return [(number, line) for number, line in stripped if line and not line.startswith("#")]
