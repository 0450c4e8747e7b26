"""CPU time and memory of the nodes on this machine."""

from __future__ import annotations

import contextlib
import socket
from collections.abc import Iterable

import psutil

from semmap.nodes.extern.web.views.system_status import Load
from semmap.schemas.health import Health


def measure_loads(beats: Iterable[Health]) -> dict[int, Load]:
    """Return the load of each node that runs on this machine, by process id."""
    own_host = socket.gethostname()
    found: dict[int, Load] = {}
    for beat in beats:
        if beat.host in ("", own_host):
            with contextlib.suppress(psutil.Error):
                process = psutil.Process(beat.pid)
                with process.oneshot():
                    times = process.cpu_times()
                    found[beat.pid] = Load(times.user + times.system, process.memory_info().rss)
    return found
