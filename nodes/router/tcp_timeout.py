"""Ends TCP connections without acknowledgements early, where the operating system supports it.

Zenoh (1.10.2) drops a link after its lease, but first closes it in an orderly way. If the socket's buffer is
full, that waits for TCP's increasingly rare retransmissions. A link that was interrupted for 15 s reconnected
only 12 s after the network was back.
"""

from __future__ import annotations

import contextlib
import os
import socket
from pathlib import Path
from typing import Final

_OPTION: Final[int | None] = getattr(socket, "TCP_USER_TIMEOUT", None)
_OWN: Final = Path("/proc/self/fd")


def set_user_timeout(seconds: float) -> int:
    """Set the user time-out of all TCP connections of this process.

    A connection ends if sent data is not acknowledged within it. Returns the number of connections. Must be
    called regularly for new connections.
    """
    if _OPTION is None or not _OWN.is_dir():
        return 0
    found = 0
    for entry in _OWN.iterdir():
        with contextlib.suppress(OSError):  # closed in the meantime, or not TCP
            if not entry.is_socket():
                continue
            with socket.socket(fileno=os.dup(int(entry.name))) as one:
                one.setsockopt(socket.IPPROTO_TCP, _OPTION, int(seconds * 1000))
                found += 1
    return found
