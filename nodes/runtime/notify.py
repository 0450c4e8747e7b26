"""Tells the supervisor of this process how it is, past the network: a datagram to the socket it was given.

The supervisor judges a node by these alone. So neither another node that hangs, nor a cut network, nor
anybody who publishes heartbeats under a node's name has a say in whether it is replaced.
"""

from __future__ import annotations

import contextlib
import os
import socket

from semmap.schemas import codec
from semmap.schemas.health import Health

NOTIFY_VARIABLE = "SEMMAP_NOTIFY"
"""The path of the supervisor's datagram socket; unset where nobody supervises."""


def notify(health: Health) -> None:
    """Tell the supervisor, if there is one, how this node is; never waits: one that is busy misses it."""
    path = os.environ.get(NOTIFY_VARIABLE)
    if not path:
        return
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as sender, contextlib.suppress(OSError):
        sender.setblocking(False)
        sender.sendto(codec.encode(health), path)
