"""Cuts the links of a whole system under load, in its own network namespace (`unshare -rn`)."""

from __future__ import annotations

import contextlib
import fcntl
import json
import socket
import struct
import sys
import tempfile
import time
from pathlib import Path

from tests.faults.ground import Ground
from tests.faults.table import SMALL

_SIOCSIFFLAGS = 0x8914
_IFF_UP = 1


def main(seconds: float) -> None:
    """Print lost and doubled changes, and the time until recovery [s]."""
    _link(up=True)
    with (
        tempfile.TemporaryDirectory(prefix="semmap-cut-") as folder,
        contextlib.closing(Ground(Path(folder, "data"), SMALL)) as ground,
    ):
        ground.seconds_until_whole()
        _link(up=False)
        time.sleep(seconds)
        _link(up=True)
        whole_s = ground.seconds_until_whole()
        lost, doubled = ground.reckon()
        unanswered, added = ground.load.unanswered, len(ground.load.added)
    print(
        json.dumps(
            {"lost": lost, "doubled": doubled, "whole_s": whole_s, "added": added, "unanswered": unanswered}
        )
    )


def _link(*, up: bool) -> None:
    """Switch the loopback interface, which carries all traffic here, up or down."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as asked:
        request = struct.pack("16sh14x", b"lo", _IFF_UP if up else 0)
        fcntl.ioctl(asked.fileno(), _SIOCSIFFLAGS, request)


if __name__ == "__main__":
    main(float(sys.argv[1]))
