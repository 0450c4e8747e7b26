"""Health reports of the nodes to `semmap up`, as datagrams on a unix socket of this user."""

from __future__ import annotations

import contextlib
import select
import socket
from collections.abc import Iterator
from pathlib import Path

from semmap.schemas import codec, errors
from semmap.schemas.health import Health

_MOST_BYTES = 1 << 16


class Notices:
    """The receiving end. Owned by the thread that reads it."""

    def __init__(self, path: Path) -> None:
        """Listen at `path`, which is replaced. Raises Refused if that fails."""
        self.path = path
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        try:
            path.unlink(missing_ok=True)
            self._socket.bind(str(path))
            path.chmod(0o600)
        except OSError as error:
            self._socket.close()
            raise errors.Refused(f"cannot open the socket {path}: {error.strerror}") from None
        self._socket.setblocking(False)

    def wait(self, timeout_s: float) -> Iterator[Health]:
        """Yield the received reports after waiting up to `timeout_s`; invalid datagrams are dropped."""
        select.select([self._socket], [], [], timeout_s)
        while True:
            try:
                datagram = self._socket.recv(_MOST_BYTES)
            except BlockingIOError:
                return
            with contextlib.suppress(errors.BadRequest):
                yield codec.decode(datagram, Health)

    def close(self) -> None:
        """Stop listening."""
        self._socket.close()
        self.path.unlink(missing_ok=True)
