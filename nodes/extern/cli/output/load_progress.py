"""Progress of loading a large file, on stderr."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager

from nodes import bus
from nodes.extern.cli.output.printable import say
from nodes.extern.client import Client
from schemas import keys
from schemas.health import LOADING, Health

_PATIENCE_S = 2.0


@contextmanager
def progress(client: Client) -> Iterator[None]:
    """Meanwhile what the knowledge base tells of its loading goes to stderr; nothing when it is soon done."""
    from_s = time.monotonic() + _PATIENCE_S

    def tell(_: str, health: Health) -> None:
        if health.detail.startswith(LOADING) and time.monotonic() > from_s:
            say(f"semmap: {health.detail}", file=sys.stderr)

    subscriber = bus.follow(client.session, keys.HEALTH, tell)
    try:
        yield
    finally:
        subscriber.undeclare()
