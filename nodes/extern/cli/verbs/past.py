"""The verbs about the past: `history`, `last-seen`, `undo`."""

from __future__ import annotations

import click

from nodes.extern.cli.calling import TIME, print_json, print_lines, talks
from nodes.extern.cli.completing import entity_names
from nodes.extern.cli.output import show, show_past
from nodes.extern.client import Client

_format = click.option(
    "--format", "format", type=click.Choice(["table", "json"]), default="table", show_default=True
)


@click.command()
@click.argument("name", required=False, shell_complete=entity_names)
@click.option("--since", metavar="COMMIT|TIME", help="From this on.")
@click.option("--until", metavar="COMMIT|TIME", help=f"Up to the end of this. {TIME}")
@click.option("--limit", type=int, default=20, show_default=True, help="At most so many, the newest.")
@_format
@talks
def history(
    client: Client, name: str | None, since: str | None, until: str | None, limit: int, format: str
) -> None:
    """The commits, or those that touched an entity, newest last: who, when, why, what."""
    commits = client.history(name, since=since, until=until, limit=limit)
    if format == "json":
        print_json(commits)
        return
    if commits:
        show.console().print(show_past.history_table(commits))
    print(f"{len(commits)} {'commit' if len(commits) == 1 else 'commits'}")


@click.command("last-seen")
@click.argument("name", shell_complete=entity_names)
@_format
@talks
def last_seen(client: Client, name: str, format: str) -> None:
    """When, where and by whom an entity was last seen or put, even if it is no more."""
    sighting = client.last_seen(name)
    if format == "json":
        print_json(sighting)
    else:
        show.console().print(show_past.sighting_card(sighting))


@click.command()
@click.argument("commit", type=int, required=False)
@click.option("--dry-run", is_flag=True, help="Say what would change, and change nothing.")
@talks
def undo(client: Client, commit: int | None, dry_run: bool) -> None:
    """Take back a commit, unless later ones rest on it; without one, the newest that a client asked for."""
    print_lines(show.changed(client.undo(commit, dry_run=dry_run)))
