"""The command `web`: the map in a browser."""

from __future__ import annotations

import os

import click

from semmap.nodes.extern.cli.command import command
from semmap.nodes.extern.cli.common import connect_option, identity_option, namespace_option, print_error
from semmap.nodes.extern.cli.output.printable import print_escaped
from semmap.nodes.runtime import extras
from semmap.schemas import errors
from semmap.schemas.endpoints import WEB_TOKEN_VARIABLE

_HOST = "127.0.0.1"
_PORT = 8080
_LOOPBACK = ("127.0.0.1", "localhost", "::1")


@command(example="semmap web --port 8080")
@click.option(
    "--port",
    type=click.IntRange(0, 65_535),
    default=_PORT,
    show_default=True,
    help="Port; 0 selects a free port.",
)
@click.option(
    "--listen",
    "host",
    default=_HOST,
    show_default=True,
    metavar="HOST",
    help="Address to listen on; addresses of other interfaces than loopback require --insecure.",
)
@click.option("--insecure", is_flag=True, help="Accept connections from other hosts over plain HTTP.")
@connect_option
@identity_option
@namespace_option
def web(
    port: int, host: str, insecure: bool, where: str | None, identity: str | None, namespace: str | None
) -> None:
    """Show and edit the map in a browser.

    The command prints the address to open, which includes a token, and runs until Ctrl-C. In a secure system,
    the page has the permissions of --identity.
    """
    extras.require("semmap web", "web")
    if host not in _LOOPBACK:
        if not insecure:
            raise errors.BadRequest(
                f"{host}: other hosts could take over a page over plain HTTP; use an SSH tunnel"
                f" (ssh -L {port}:127.0.0.1:{port} THIS_HOST) or add --insecure"
            )
        print_error(f"warning: the page at {host} uses plain HTTP: its token and the map are not encrypted")
    from semmap.nodes.extern.web.server import WebConfig, resolve_network, run

    network = resolve_network(where, identity, namespace)
    token = os.environ.get(WEB_TOKEN_VARIABLE, "")
    run(WebConfig(network=network, host=host, port=port, token=token), on_ready=print_escaped)
