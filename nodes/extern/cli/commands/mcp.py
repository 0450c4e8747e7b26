"""The command `mcp`: the map for language-model agents."""

from __future__ import annotations

import contextlib
import functools
import os
import signal
import sys
from collections.abc import Callable, Iterator
from types import FrameType
from typing import TYPE_CHECKING, Any

import click

from semmap.nodes import bus
from semmap.nodes.extern.cli.command import command
from semmap.nodes.extern.cli.common import connect_option, identity_option, namespace_option, other_robots
from semmap.nodes.extern.cli.output.printable import print_escaped
from semmap.nodes.runtime import extras
from semmap.schemas import errors

if TYPE_CHECKING:
    from semmap.nodes.extern.mcp.changes import Changes
    from semmap.nodes.extern.mcp.lazy_client import LazyClient
    from semmap.nodes.extern.mcp.tools import Tools


def _with_its_extra(function: Callable[..., None]) -> Callable[..., None]:
    """Check that the extra `mcp` is installed before the command connects to a system."""

    @functools.wraps(function)
    def checked(**arguments: Any) -> None:
        extras.require("semmap mcp", "mcp")
        function(**arguments)

    return checked


def _names(_: click.Context, __: click.Parameter, value: str | None) -> frozenset[str]:
    """Split a comma-separated list of names."""
    return frozenset(filter(None, (word.strip() for word in (value or "").split(","))))


@command(example="semmap mcp --allow change --places kitchen1 --approve")
@click.option("--allow", type=click.Choice(["change"]), help="Also let agents change the map.")
@click.option(
    "--classes", callback=_names, metavar="CLASSES", help="Changes only to these classes, such as Cup,Book."
)
@click.option(
    "--places", callback=_names, metavar="PLACES", help="Changes only in these places, such as kitchen1."
)
@click.option(
    "--rate", type=click.FloatRange(min=0.1, max=6000.0), help="Changes per minute, at most. Default: 30."
)
@click.option("--approve", is_flag=True, help="Changes require approval by a person: semmap approve.")
@click.option(
    "--agent",
    default="agent",
    show_default=True,
    metavar="NAME",
    help="Author of the changes in the history.",
)
@click.option(
    "--http",
    type=click.IntRange(0, 65_535),
    is_flag=False,
    flag_value=7448,
    metavar="[PORT]",
    help="Serve over HTTP on this machine (port 7448), for clients with the printed token.",
)
@_with_its_extra
@connect_option
@identity_option
@namespace_option
def mcp(
    where: str | None,
    identity: str | None,
    namespace: str | None,
    allow: str | None,
    classes: frozenset[str],
    places: frozenset[str],
    rate: float | None,
    approve: bool,
    agent: str,
    http: int | None,
) -> None:
    """Serve the map to language-model agents over MCP.

    The server uses the Model Context Protocol on standard input and output; the host of the agent starts it.
    It is read-only by default. With --allow change, an agent proposes a change, reads its consequences, and
    commits it. The server may start before the system: until then, its tools report that it is not running.
    """
    limits = [
        option
        for option, value in (
            ("--classes", classes),
            ("--places", places),
            ("--rate", rate),
            ("--approve", approve),
        )
        if value
    ]
    if limits and allow is None:
        raise errors.BadRequest(f"{limits[0]} requires --allow change")
    from semmap.nodes.extern import connection
    from semmap.nodes.extern.client import connect
    from semmap.nodes.extern.mcp.lazy_client import LazyClient
    from semmap.nodes.extern.mcp.tools import Tools, change_tools

    certificate = connection.identity(identity)
    # A client and not a peer: it connects faster, and again after a restart of the system.
    client = LazyClient(
        functools.partial(connect, where, agent=agent, identity=identity, namespace=namespace, mode="client")
    )
    changes = (
        _changes(agent if certificate is None else certificate.name, classes, places, rate, approve)
        if allow
        else None
    )
    try:
        with _withdrawing_requests(client, changes):
            _check(client, changes, lambda: other_robots(where, identity, namespace))
            _serve(Tools(client, change_tools(changes) if changes else ()), http)
    finally:
        client.close()


@contextlib.contextmanager
def _withdrawing_requests(client: LazyClient, changes: Changes | None) -> Iterator[None]:
    """Withdraw the pending requests of the agent at the end, also if SIGTERM ends the process.

    An exception of the signal handler would not end it: a thread reads stdin until the host closes that.
    """

    def withdraw() -> None:
        if changes is not None and client.connected is not None:
            changes.withdraw_requests(client.connected)

    def terminate(number: int, _: FrameType | None) -> None:
        signal.signal(number, signal.SIG_DFL)  # a second signal ends the process at once
        try:
            withdraw()
        finally:
            signal.raise_signal(number)

    before = signal.signal(signal.SIGTERM, terminate)
    try:
        yield
    finally:
        withdraw()
        signal.signal(signal.SIGTERM, before)


def _check(client: LazyClient, changes: Changes | None, others: Callable[[], tuple[str, ...]]) -> None:
    """Connect, and check the limits; print a note if the system is not running, with the `others()` that are.

    Raises NoAnswer if waiting does not help: the system rejects the client.
    """
    try:
        connected = client()
        if changes is not None:
            changes.check_limits(connected)
    except bus.ConnectionClosed:
        raise
    except errors.NoAnswer as error:
        there = others() if client.connected is not None else ()
        hint = f"; available robots: {', '.join(there)}" if there else ""
        print_escaped(f"note: {error.text}{hint}; the tools wait for it", file=sys.stderr)


def _serve(tools: Tools, http: int | None) -> None:
    """Serve on standard input and output, or on the port `http` of this machine."""
    if http is None:
        from semmap.nodes.extern.mcp.server import run_stdio

        run_stdio(tools)
        return
    from semmap.nodes.extern.mcp.http import TOKEN_VARIABLE, choose_token, run_http

    run_http(
        tools,
        http,
        choose_token(os.environ.get(TOKEN_VARIABLE)),
        lambda text: print_escaped(text, file=sys.stderr),
    )


def _changes(
    agent: str, classes: frozenset[str], places: frozenset[str], rate: float | None, approve: bool
) -> Changes:
    from semmap.nodes.extern.mcp.changes import Changes
    from semmap.nodes.extern.mcp.limits import CHANGES_PER_MIN, Limits

    return Changes(
        agent,
        allowed=Limits(classes=classes, places=places),
        per_min=rate or CHANGES_PER_MIN,
        approve=approve,
    )
