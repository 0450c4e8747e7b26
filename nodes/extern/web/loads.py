"""What the nodes of this machine use of it."""

from __future__ import annotations

import contextlib
import socket
from collections.abc import Iterable

import psutil  # type: ignore[import-untyped]

from semmap.nodes.extern.web.views.rates import Load
from semmap.schemas.health import Health


def loads_of(beats: Iterable[Health]) -> dict[int, Load]:
    """By process id, the load of each node that runs here; of others, and of dead ones, nothing is known."""
    here = socket.gethostname()
    found: dict[int, Load] = {}
    for beat in beats:
        if beat.host in ("", here):
            with contextlib.suppress(psutil.Error):
                process = psutil.Process(beat.pid)
                with process.oneshot():
                    spent = process.cpu_times()
                    found[beat.pid] = Load(spent.user + spent.system, process.memory_info().rss)
    return found
