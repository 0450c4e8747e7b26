"""The command `fleet`: robots are mirrored to a SPARQL server, and queried there."""

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
    help="Robots whose names match, such as 'arm*,lift1'.",
)
_query_url = functools.partial(click.option, "--sparql-query", "query_url", metavar="URL")


@group(example="semmap fleet mirror --sparql-update http://127.0.0.1:7878/update")
def fleet() -> None:
    """Mirror the maps of robots to a SPARQL server and query it."""


@fleet.command(example="semmap fleet mirror --sparql-update http://127.0.0.1:7878/update")
@click.option(
    "--sparql-update", "update_url", metavar="URL", required=True, help="Update endpoint of the server."
)
@_query_url(help="Query endpoint of the server. Default: the update URL with query instead of update.")
@_robots
@click.option(
    "--frame",
    "frames",
    multiple=True,
    metavar="ROBOT=X,Y,Z,YAW",
    help="Pose of a robot's map in the fleet frame [m, rad]; stored. May be repeated.",
)
@click.option("--once", is_flag=True, help="Synchronize with the available robots, then exit.")
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
    """Copy the maps of robots to named graphs of a SPARQL server.

    Each robot has one graph, which is updated with its commits until Ctrl-C. A restarted mirror resumes at
    the last commit. It waits for robots and servers that are down. The URL may include a user and a password.
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
@_query_url(required=True, help="Query endpoint of the server.")
@_robots
@click.option("--format", type=click.Choice(["table", "json"]), default="table", show_default=True)
@connect_option
@identity_option
def sparql_(
    query: str, query_url: str, robots: str, format: str, where: str | None, identity: str | None
) -> None:
    """Run a SELECT or ASK query across the mirrored robots.

    The default graph is the union of the graphs of all robots; GRAPH ?robot { ... } is the graph of one
    robot. The result includes the commit of each graph and, for a robot that can be reached, how many commits
    the graph is behind. Predefined prefixes: dm: (TBox), : (ABox), fleet:, rdf:, rdfs:, owl:, xsd:.
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
