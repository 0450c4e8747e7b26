"""Reports this process's health to its supervisor, as a datagram on a unix socket.

The supervisor judges a node only by these datagrams. Other hanging nodes, a broken network or forged
heartbeats therefore do not affect whether it is restarted.
"""

from __future__ import annotations

import contextlib
import os
import socket

from semmap.schemas import codec
from semmap.schemas.health import Health

NOTIFY_VARIABLE = "SEMMAP_NOTIFY"
"""The path of the supervisor's datagram socket; unset without a supervisor."""


def notify(health: Health) -> None:
    """Send the health of this node to the supervisor, if there is one; never waits."""
    path = os.environ.get(NOTIFY_VARIABLE)
    if not path:
        return
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as sender, contextlib.suppress(OSError):
        sender.setblocking(False)
        sender.sendto(codec.encode(health), path)
