"""The verb `mcp`: the map for language-model agents."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import click

from nodes.extern.cli.calling import talks
from nodes.runtime import extras

if TYPE_CHECKING:
    from nodes.extern.client import Client


def _with_its_extra(function: Callable[..., None]) -> Callable[..., None]:
    """A verb that says what it lacks before it connects to a system."""

    @functools.wraps(function)
    def checked(**arguments: Any) -> None:
        extras.require("semmap mcp", "mcp")
        function(**arguments)

    return checked


@click.command()
@_with_its_extra
@talks
def mcp(client: Client) -> None:
    """Serve the map to language-model agents, over MCP.

    It speaks the Model Context Protocol on standard input and output, as hosts that start it expect. It only
    reads.
    """
    from nodes.extern.mcp.server import run_stdio
    from nodes.extern.mcp.tools import Tools

    run_stdio(Tools(client))
