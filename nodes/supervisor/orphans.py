"""Ends processes whose supervisor is gone.

A process of a system exits when its parent does: supervisord with `semmap up`, a node with supervisord. A
process that cannot (it is stopped or hangs) is found by its command line and killed by the next `semmap up`
or `semmap down` of the same data folder.
"""

from __future__ import annotations

import contextlib
import os
import signal
import threading
import time
from pathlib import Path

import psutil

_LOOK_S = 0.25
_STOP_S = 5.0
"""Seconds for a leftover process to stop before it is killed; acknowledged changes are not lost."""
_STOP_ALONE_S = 40.0
"""Seconds for an orphan to stop by itself: it may be writing a checkpoint."""


def end_when_orphaned() -> None:
    """Stop this process (SIGTERM to itself) when its parent ends."""
    parent = os.getppid()

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(_LOOK_S)
        os.kill(os.getpid(), signal.SIGTERM)
        time.sleep(_STOP_ALONE_S)
        os._exit(1)

    threading.Thread(target=watch, daemon=True, name="end-when-orphaned").start()


def processes_with(path: Path) -> list[psutil.Process]:
    """Return this user's other semmap processes whose command line contains the file `path`."""
    found = []
    for process in psutil.process_iter():
        with contextlib.suppress(psutil.Error):
            if process.uids().real == os.getuid() and process.pid != os.getpid():
                words = process.cmdline()
                if str(path) in words and any(word.startswith("semmap.nodes.supervisor.") for word in words):
                    found.append(process)
    return found


def end_all(*paths: Path) -> int:
    """End the processes whose command line contains one of these files, with their children.

    They are terminated, then killed after a time-out. Returns their number.
    """
    found = [process for path in paths for process in processes_with(path)]
    family = {*found}
    for process in found:
        with contextlib.suppress(psutil.Error):
            family.update(process.children(recursive=True))
    for process in found:
        with contextlib.suppress(psutil.Error):
            process.terminate()
    _, alive = psutil.wait_procs(family, timeout=_STOP_S if found else 0.0)
    for process in alive:
        with contextlib.suppress(psutil.Error):
            process.kill()
    psutil.wait_procs(alive, timeout=_STOP_S)
    return len(found)
