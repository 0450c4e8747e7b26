"""The verb `web`: the map in a browser."""

from __future__ import annotations

import click

from nodes.extern.cli.calling import connect_option, identity_option, namespace_option
from nodes.extern.cli.output.printable import say
from nodes.runtime import extras

_PORT = 8080


@click.command()
@click.option(
    "--port",
    type=click.IntRange(0, 65_535),
    default=_PORT,
    show_default=True,
    help="Port; 0 is any free one.",
)
@connect_option
@identity_option
@namespace_option
def web(port: int, where: str | None, identity: str | None, namespace: str | None) -> None:
    """Show the map in a browser, to look at and to work on.

    It prints the address to open, with a token in it, and runs until Ctrl-C.
    """
    extras.require("semmap web", "web")
    from nodes.extern.web.joining import network_of
    from nodes.extern.web.server import WebConfig, run

    run(WebConfig(network=network_of(where, identity, namespace), port=port), tell=say)
