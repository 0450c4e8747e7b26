"""Progress of a large change, on stderr."""

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
_REPEAT_S = 5.0
"""Period after which an unchanged message is printed again [s]."""


@contextmanager
def progress(client: Client) -> Iterator[None]:
    """Print the progress of the knowledge base to stderr, unless the change takes less than 2 s."""
    began_s = time.monotonic()
    printed, printed_s = "", 0.0

    def print_progress(_: str, health: Health) -> None:
        nonlocal printed, printed_s
        now_s = time.monotonic()
        if not health.detail.startswith(WORKING) or now_s < began_s + _PATIENCE_S:
            return
        if health.detail != printed or now_s > printed_s + _REPEAT_S:
            printed, printed_s = health.detail, now_s
            print_escaped(f"semmap: {health.detail} ({now_s - began_s:.0f} s)", file=sys.stderr)

    subscriber = bus.follow(client.session, keys.HEALTH, print_progress)
    try:
        yield
    finally:
        subscriber.undeclare()
