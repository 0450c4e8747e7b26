"""Connections that nothing comes back on are given up by the operating system, where it can be told to.

Zenoh (1.10.2) gives up a link after its lease, but first closes it in an orderly way. Where the socket's
buffer is full that waits until TCP has sent again, which it does ever later: a link that was cut for 15 s was
not tried anew until 12 s after it was back.
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
    """Let every TCP connection of this process end when what it has sent is not acknowledged for so long.

    Returns how many there are. To be called again and again, because there will be others.
    """
    if _OPTION is None or not _OWN.is_dir():
        return 0
    found = 0
    for entry in _OWN.iterdir():
        with contextlib.suppress(OSError):  # closed meanwhile, or no TCP
            if not entry.is_socket():
                continue
            with socket.socket(fileno=os.dup(int(entry.name))) as one:
                one.setsockopt(socket.IPPROTO_TCP, _OPTION, int(seconds * 1000))
                found += 1
    return found
