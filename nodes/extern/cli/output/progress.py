"""How far a large change is, on stderr."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager

from semmap.nodes import bus
from semmap.nodes.extern.cli.output.printable import print_escaped
from semmap.nodes.extern.client import Client
from semmap.schemas import keys
from semmap.schemas.health import WORKING, Health

_PATIENCE_S = 2.0
_AGAIN_S = 5.0
"""After this time the same is said again."""


@contextmanager
def progress(client: Client) -> Iterator[None]:
    """Meanwhile what the knowledge base tells of its work goes to stderr; nothing when it is soon done."""
    began_s = time.monotonic()
    said, said_s = "", 0.0

    def tell(_: str, health: Health) -> None:
        nonlocal said, said_s
        now_s = time.monotonic()
        if not health.detail.startswith(WORKING) or now_s < began_s + _PATIENCE_S:
            return
        if health.detail != said or now_s > said_s + _AGAIN_S:
            said, said_s = health.detail, now_s
            print_escaped(f"semmap: {health.detail} ({now_s - began_s:.0f} s)", file=sys.stderr)

    subscriber = bus.follow(client.session, keys.HEALTH, tell)
    try:
        yield
    finally:
        subscriber.undeclare()
