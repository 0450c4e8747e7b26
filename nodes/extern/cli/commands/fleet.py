"""The verb `fleet`: robots mirrored into a SPARQL server, and asked there."""

from __future__ import annotations

import functools
import signal
import time
from typing import TYPE_CHECKING

import click

from semmap.nodes.extern.cli.command import group
from semmap.nodes.extern.cli.commands import sparql_output
from semmap.nodes.extern.cli.common import connect_option, identity_option, print_json
from semmap.nodes.extern.cli.output.printable import print_escaped

if TYPE_CHECKING:
    from semmap.nodes.extern.fleet.query import CopiedRobot

_robots = click.option(
    "--robots",
    default="*",
    show_default=True,
    metavar="GLOB",
    help="The robots whose names match, such as 'arm*,lift1'.",
)
_query_url = functools.partial(click.option, "--sparql-query", "query_url", metavar="URL")


@group(example="semmap fleet mirror --sparql-update http://127.0.0.1:7878/update")
def fleet() -> None:
    """Mirror robots' maps into a SPARQL server, and ask there."""


@fleet.command(example="semmap fleet mirror --sparql-update http://127.0.0.1:7878/update")
@click.option(
    "--sparql-update", "update_url", metavar="URL", required=True, help="The server's update endpoint."
)
@_query_url(help="Its query endpoint. Default: as for updates, with query for update.")
@_robots
@click.option(
    "--frame",
    "frames",
    multiple=True,
    metavar="ROBOT=X,Y,Z,YAW",
    help="Where a robot's map is in the fleet's frame [m, rad]; it is kept. May be repeated.",
)
@click.option("--once", is_flag=True, help="Catch up with the robots that are there, and end.")
@connect_option
@identity_option
def mirror(
    update_url: str,
    query_url: str | None,
    robots: str,
    frames: tuple[str, ...],
    once: bool,
    where: str | None,
    identity: str | None,
) -> None:
    """Copy robots' maps into named graphs of a SPARQL server.

    One graph for each robot. It follows their commits until Ctrl-C, goes on where it was when it is started
    again, and waits for robots and servers that are down. The URL may have a user and a password.
    """
    from semmap.nodes.extern.fleet import mirror_config

    def tell(text: str) -> None:
        print_escaped(f"{time.strftime('%H:%M:%S')}  {text}")

    running = mirror_config.mirror(
        update_url, query_url, robots=robots, frames=frames, where=where, identity=identity, tell=tell
    )
    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, lambda *_: running.stop())
    running.run(once=once)


@fleet.command(
    "sparql", example='semmap fleet sparql --sparql-query http://server/query "ASK { ?c a dm:Cup }"'
)
@click.argument("query")
@_query_url(required=True, help="The server's query endpoint.")
@_robots
@click.option("--format", type=click.Choice(["table", "json"]), default="table", show_default=True)
@connect_option
@identity_option
def sparql_(
    query: str, query_url: str, robots: str, format: str, where: str | None, identity: str | None
) -> None:
    """Run a SELECT or ASK across the mirrored robots.

    The default graph is what all of them say, and GRAPH ?robot { ... } what one of them says. Beside the
    answer is the commit that each robot's graph is as of, and how many the robot is ahead if it can be
    reached. Predefined prefixes: dm: (TBox), : (ABox), fleet:, rdf:, rdfs:, owl:, xsd:.
    """
    from semmap.nodes.extern.fleet.query import sparql

    answer = sparql(sparql_output.read_query(query), query_url, robots, where=where, identity=identity)
    if format == "json":
        print_json(answer)
        return
    if answer.result.kind == "ask":
        print_escaped("true" if answer.result.verdict else "false")
    elif answer.result.rows:
        sparql_output.print_rows(answer.result.variables, answer.result.rows)
    for robot in answer.robots:
        print_escaped(f"  {robot.robot}: {_as_of(robot)}")


def _as_of(robot: CopiedRobot) -> str:
    if robot.commit is None:
        return robot.note
    until = f" to {robot.until}" if robot.until else ""
    epoch = f", epoch {robot.epoch}" if robot.epoch > 1 else ""
    behind = "" if robot.behind is None else f", {robot.behind} behind" if robot.behind else ", up to date"
    return f"commit {robot.commit}{until}{epoch}{behind}" + (f"; {robot.note}" if robot.note else "")
