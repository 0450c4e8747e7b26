"""The commands about the history: `history`, `last-seen`, `diff`, `when`, `undo`."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

import click

from semmap.nodes.extern.cli import output
from semmap.nodes.extern.cli.command import command
from semmap.nodes.extern.cli.common import (
    TIME,
    json_option,
    print_count,
    print_json,
    print_lines,
    print_result,
    with_client,
)
from semmap.nodes.extern.cli.output import lines
from semmap.nodes.extern.cli.shell_completion import entity_names
from semmap.schemas import errors, wording

if TYPE_CHECKING:
    from semmap.nodes.extern.client import Client

_MOST = 10_000
"""The largest number of commits in a reply."""
_format = click.option(
    "--format", "format", type=click.Choice(["table", "json"]), default="table", show_default=True
)

_text_or_json = click.option(
    "--format", "format", type=click.Choice(["text", "json"]), default="text", show_default=True
)
_PIPED_WIDTH = 120
"""Columns, if the output is not a terminal: the list of changes can be long."""


@command(example="semmap history cup1 --since 12:30")
@click.argument("name", required=False, shell_complete=entity_names)
@click.option("--since", metavar="COMMIT|TIME", help="First commit.")
@click.option("--until", metavar="COMMIT|TIME", help=f"Last commit. {TIME}")
@click.option("--by", metavar="AUTHOR", help="Only commits of this agent or source, such as perception.")
@click.option(
    "--in",
    "in_",
    metavar="PLACE",
    shell_complete=entity_names,
    help="Only commits that changed something in this place or container.",
)
@click.option(
    "--on", metavar="THING", shell_complete=entity_names, help="Only commits that changed something on it."
)
@click.option(
    "--limit",
    type=click.IntRange(1, _MOST),
    default=20,
    show_default=True,
    help="Number of commits; the newest are shown.",
)
@_format
@with_client
def history(
    client: Client,
    name: str | None,
    since: str | None,
    until: str | None,
    limit: int,
    format: str,
    **only: Any,
) -> None:
    """Show the newest commits, or those of one entity, in order."""
    found = client.history(name, since=since, until=until, limit=min(limit + 1, _MOST), **only)
    commits = found[-limit:]
    if format == "json":
        print_json(commits)
        return
    if commits:
        output.show.console(_PIPED_WIDTH).print(output.show.history_table(commits))
    if len(found) == len(commits):
        print_count(wording.counted(len(commits), "commit"))
    elif not any((name, since, until, *only.values())):
        print_count(f"newest {len(commits)} of {commits[-1].seq} commits; for more: --limit N")
    else:
        print_count(f"newest {wording.counted(len(commits), 'commit')}; for more: --limit N")


@command("last-seen", example="semmap last-seen cup1")
@click.argument("name", shell_complete=entity_names)
@_format
@with_client
def last_seen(client: Client, name: str, format: str) -> None:
    """Show where and when an entity was last seen or placed.

    The entity may have been removed since. The status distinguishes entities that were observed to be gone
    from entities that were not observed again.
    """
    sighting = client.last_seen(name)
    if format == "json":
        print_json(sighting)
    else:
        output.show.console().print(output.show.sighting_card(sighting))


@command(example="semmap diff 12:30")
@click.argument("since", metavar="COMMIT|TIME")
@click.argument("until", metavar="[COMMIT|TIME]", required=False)
@click.option("--on", metavar="THING", shell_complete=entity_names, help="Only what came onto it or left it.")
@click.option(
    "--in", "in_", metavar="PLACE", shell_complete=entity_names, help="Only what came into it or left it."
)
@_text_or_json
@with_client
def diff(client: Client, since: str, until: str | None, format: str, **where: Any) -> None:
    """Show what changed between two commits or times.

    Without a second argument, show what has changed since the first.
    """
    found = client.diff(since, until, **where)
    if format == "json":
        print_json(found)
    else:
        print_lines(lines.format_difference(found))


@command(example="semmap when cup1 isOn table1")
@click.argument("name", shell_complete=entity_names)
@click.argument("relation")
@click.argument("other", metavar="[OTHER|VALUE]", required=False, shell_complete=entity_names)
@_text_or_json
@with_client
def when(client: Client, name: str, relation: str, other: str | None, format: str) -> None:
    """Show when a relation or the value of a property held.

    RELATION is isOn, isInside, isLocatedIn, isNear or isAttachedTo, or a property such as isOpen. Without
    VALUE, the property is true. Stored live poses of tracked entities count, too:
    see semmap trail. The exit status is 1 if the relation never held.
    """
    found = client.when(name, relation, True if other is None else other)
    if format == "json":
        print_json(found)
    else:
        print_lines([found.text])
    if not (found.spells or found.visits):
        sys.exit(errors.Refused.exit_status)


@command(example="semmap trail robot1 --in kitchen1 --since yesterday")
@click.argument("name", shell_complete=entity_names)
@click.option("--since", metavar="COMMIT|TIME", help="Begin of the period.")
@click.option("--until", metavar="COMMIT|TIME", help=f"End of the period. {TIME}")
@click.option("--at", metavar="COMMIT|TIME", help="Only the position at a time.")
@click.option("--in", "in_", metavar="PLACE", shell_complete=entity_names, help="Only visits of this place.")
@click.option(
    "--limit",
    type=click.IntRange(1, _MOST),
    default=20,
    show_default=True,
    help="Number of visits; the newest are shown.",
)
@click.option(
    "--points",
    type=click.IntRange(0, _MOST),
    default=1000,
    show_default=True,
    help="With --format json: number of positions, evenly selected.",
)
@_format
@with_client
def trail(client: Client, name: str, format: str, points: int, **fields: Any) -> None:
    """Show when a tracked entity entered and left places.

    Live poses of tracked entities are stored as a trail, which also has the places that were passed without a
    stop. NAME may be a class or label of several entities. The exit status is 1 if there was no visit.
    """
    found = client.trail(name, points=points if format == "json" else 1, **fields)
    if format == "json":
        print_json(found)
    else:
        if found.visits and fields["at"] is None:
            output.show.console(_PIPED_WIDTH).print(output.show.visit_table(found.visits))
        if found.omitted_visits:
            print_count(f"{found.omitted_visits} earlier visits are not shown; for more: --limit N")
        print_lines([found.text])
    if not (found.visits if fields["at"] is None else found.track):
        sys.exit(errors.Refused.exit_status)


@command(example="semmap undo --dry-run")
@click.argument("commit", type=int, required=False)
@click.option("--dry-run", is_flag=True, help="Report what would change, without changing anything.")
@json_option
@with_client
def undo(client: Client, commit: int | None, dry_run: bool) -> None:
    """Undo a commit, unless later ones depend on it.

    Without COMMIT, undo the newest commit that a client requested.
    """
    from semmap.nodes.extern.cli.output.progress import progress

    with progress(client):
        reply = client.undo(commit, dry_run=dry_run)
    print_result(reply, lines.format_change)
