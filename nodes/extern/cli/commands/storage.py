"""The commands for the stored map and its history: `backup`, `restore`, `compact`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from semmap.nodes.extern.backup import restore as restore_map
from semmap.nodes.extern.cli.command import command
from semmap.nodes.extern.cli.common import (
    INPUT_PATH,
    json_option,
    print_error,
    print_json,
    print_text,
    with_client,
)
from semmap.nodes.extern.cli.output.printable import print_escaped

if TYPE_CHECKING:
    from semmap.nodes.extern.client import Client

_path = click.Path(path_type=Path)
_format = click.option(
    "--format", "format", type=click.Choice(["text", "json"]), default="text", show_default=True
)


@command(example="semmap backup flat.backup")
@click.argument("file", type=_path)
@click.option("--overwrite", is_flag=True, help="Replace FILE if it exists.")
@_format
@with_client
def backup(client: Client, file: Path, overwrite: bool, format: str) -> None:
    """Write the map and its history to FILE.

    The system keeps running. The backup has the state at the start of the command, and is verified by
    its digests. See also: semmap restore.
    """
    opening = client.backup(file, overwrite=overwrite)
    if format == "json":
        print_json(opening)
        return
    size = file.stat().st_size / 1e6
    print_escaped(f"map {opening.map_id[:12]} up to commit {opening.last}, {size:,.1f} MB, verified: {file}")


@command(example="semmap restore flat.backup --data maps/restored")
@click.argument("file", type=INPUT_PATH)
@click.option("--data", type=_path, required=True, help="Data folder to restore the map to.")
@click.option("--replace", is_flag=True, help="Move an existing map to DIR/kept.")
@json_option
def restore(file: Path, data: Path, replace: bool) -> None:
    """Restore a backup to a data folder.

    The system of that folder must be stopped. Afterwards, start it: semmap up --data DIR.
    """
    print_text(restore_map(file, data, replace=replace, tell=print_error))


@command(example="semmap compact --keep 30d --dry-run")
@click.option(
    "--keep",
    default="30d",
    show_default=True,
    metavar="AGE",
    help="Keep commits that are newer, such as 12h or 30d.",
)
@click.option("--dry-run", is_flag=True, help="Report what would be compacted, without changing anything.")
@_format
@with_client
def compact(client: Client, keep: str, dry_run: bool, format: str) -> None:
    """Replace old commits by a snapshot to save disk space.

    The map does not change. Commits before the snapshot can no longer be queried or undone. If you may need
    them, make a backup first.
    """
    compacted = client.compact(keep=keep, dry_run=dry_run)
    if format == "json":
        print_json(compacted)
        return
    print_escaped(compacted.text)
    if compacted.commits and not dry_run:
        before, after = compacted.bytes_before / 1e6, compacted.bytes_after / 1e6
        print_escaped(f"journal size: {after:,.1f} MB (was {before:,.1f} MB)")
