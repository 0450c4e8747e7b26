"""What the verbs of the command line that talk to a system have in common."""

from __future__ import annotations

import functools
import json
import os
from collections.abc import Callable, Iterable
from typing import Any

import click

from nodes import bus
from nodes.extern.client import CONNECT_VARIABLE, Client, connect
from schemas import codec


def talks(function: Callable[..., None]) -> Callable[..., None]:
    """A verb that talks to a running system: its first argument is a client."""

    @click.option(
        "--connect",
        "where",
        envvar=CONNECT_VARIABLE,
        default=bus.DEFAULT_ENDPOINT,
        show_default=True,
        show_envvar=True,
        metavar="EP",
        help="Zenoh endpoint of the system.",
    )
    @functools.wraps(function)
    def with_client(where: str, **arguments: Any) -> None:
        shared = click.get_current_context().obj
        if isinstance(shared, Client):
            function(shared, **arguments)
            return
        with connect(where, agent=f"cli/{os.environ.get('USER', 'user')}") as client:
            function(client, **arguments)

    return with_client


def print_json(message: Any) -> None:
    """A reply as JSON."""
    print(json.dumps(json.loads(codec.encode_json(message)), indent=2, ensure_ascii=False))


def print_lines(lines: Iterable[str]) -> None:
    """A reply in words."""
    for line in lines:
        print(line)
