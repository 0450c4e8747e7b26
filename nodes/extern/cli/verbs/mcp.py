"""The verb `mcp`: the map for language-model agents."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from nodes.extern.cli.calling import talks
from nodes.runtime import extras

if TYPE_CHECKING:
    from nodes.extern.client import Client


@click.command()
@talks
def mcp(client: Client) -> None:
    """Serve the map to language-model agents, over the Model Context Protocol.

    It speaks on standard input and output, as hosts that start it expect. It only reads.
    """
    extras.require("semmap mcp", "mcp")
    from nodes.extern.mcp.server import run_stdio
    from nodes.extern.mcp.tools import Tools

    run_stdio(Tools(client))
