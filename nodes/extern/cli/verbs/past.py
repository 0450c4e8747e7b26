"""The verbs about the past: `history`, `last-seen`, `diff`, `when`, `undo`."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any, get_args

import click

from semmap.nodes.extern.cli import output
from semmap.nodes.extern.cli.calling import TIME, print_json, print_lines, talks
from semmap.nodes.extern.cli.completing import entity_names
from semmap.nodes.extern.cli.output import lines
from semmap.schemas import errors
from semmap.schemas.map_history import KeptRelation

if TYPE_CHECKING:
    from semmap.nodes.extern.client import Client

_format = click.option(
    "--format", "format", type=click.Choice(["table", "json"]), default="table", show_default=True
)

_text_or_json = click.option(
    "--format", "format", type=click.Choice(["text", "json"]), default="text", show_default=True
)
_PIPED_WIDTH = 120
"""Columns: what commits change may be a long story."""


@click.command()
@click.argument("name", required=False, shell_complete=entity_names)
@click.option("--since", metavar="COMMIT|TIME", help="Commits from here on, inclusive.")
@click.option("--until", metavar="COMMIT|TIME", help=f"Commits up to here, inclusive. {TIME}")
@click.option(
    "--limit", type=int, default=20, show_default=True, help="Maximum number of commits, the newest ones."
)
@_format
@talks
def history(
    client: Client, name: str | None, since: str | None, until: str | None, limit: int, format: str
) -> None:
    """Show the newest commits, or those of an entity, in order."""
    commits = client.history(name, since=since, until=until, limit=limit)
    if format == "json":
        print_json(commits)
        return
    if commits:
        output.show.console(_PIPED_WIDTH).print(output.show_past.history_table(commits))
    print(f"{len(commits)} {'commit' if len(commits) == 1 else 'commits'}")


@click.command("last-seen")
@click.argument("name", shell_complete=entity_names)
@_format
@talks
def last_seen(client: Client, name: str, format: str) -> None:
    """Show where and when an entity was last seen or placed.

    It may have been removed since. What was seen to be gone is told from what
    has merely not been seen since.
    """
    sighting = client.last_seen(name)
    if format == "json":
        print_json(sighting)
    else:
        output.show.console().print(output.show_past.sighting_card(sighting))


@click.command()
@click.argument("since", metavar="COMMIT|TIME")
@click.argument("until", metavar="[COMMIT|TIME]", required=False)
@_text_or_json
@talks
def diff(client: Client, since: str, until: str | None, format: str) -> None:
    """Show what changed between two commits or times.

    Without a second one: what has changed since the first.
    """
    found = client.diff(since, until)
    if format == "json":
        print_json(found)
    else:
        print_lines(lines.difference(found))


@click.command()
@click.argument("name", shell_complete=entity_names)
@click.argument("relation", metavar="RELATION", type=click.Choice(get_args(KeptRelation)))
@click.argument("other", shell_complete=entity_names)
@_text_or_json
@talks
def when(client: Client, name: str, relation: Any, other: str, format: str) -> None:
    """Show when one thing was on, in or attached to another.

    RELATION is isOn, isInside, isLocatedIn or isAttachedTo: semmap when cup1
    isOn table1. The exit status is 1 if it never was.
    """
    found = client.when(name, relation, other)
    if format == "json":
        print_json(found)
    else:
        print_lines([found.text])
    if not found.spells:
        sys.exit(errors.Refused.exit_status)


@click.command()
@click.argument("commit", type=int, required=False)
@click.option("--dry-run", is_flag=True, help="Report what would change, without changing anything.")
@talks
def undo(client: Client, commit: int | None, dry_run: bool) -> None:
    """Undo a commit, unless later ones depend on it.

    Without COMMIT it is the newest that a client requested.
    """
    from semmap.nodes.extern.cli.output.progress import progress

    with progress(client):
        reply = client.undo(commit, dry_run=dry_run)
    print_lines(lines.changed(reply))
