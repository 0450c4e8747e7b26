"""The verb `web`: the map in a browser."""

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
    help="Port; 0 is any free one.",
)
@click.option(
    "--listen",
    "host",
    default=_HOST,
    show_default=True,
    metavar="HOST",
    help="Address to listen on; one that others reach takes --insecure.",
)
@click.option("--insecure", is_flag=True, help="Listen beyond this machine, over plain HTTP.")
@connect_option
@identity_option
@namespace_option
def web(
    port: int, host: str, insecure: bool, where: str | None, identity: str | None, namespace: str | None
) -> None:
    """Show the map in a browser, to look at and to work on.

    It prints the address to open, with a token in it, and runs until Ctrl-C. To a secure system the page acts
    as --identity says, and shows only what that may do.
    """
    extras.require("semmap web", "web")
    if host not in _LOOPBACK:
        if not insecure:
            raise errors.BadRequest(
                f"over plain HTTP whoever reads the network to {host} could take over the page; come by way"
                f" of SSH (ssh -L {port}:127.0.0.1:{port} THIS_HOST), or say --insecure"
            )
        print_error(
            f"warning: the page at {host} is plain HTTP: its token and the map can be read on the way"
        )
    from semmap.nodes.extern.web.joining import network_of
    from semmap.nodes.extern.web.server import WebConfig, run

    network = network_of(where, identity, namespace)
    token = os.environ.get(WEB_TOKEN_VARIABLE, "")
    run(WebConfig(network=network, host=host, port=port, token=token), tell=print_escaped)
