"""Keeps cores from sleeping.

On a shared machine, a sleeping core is given to others, and a thread that wakes on it finds cold caches. A
command wakes threads about forty times, so keeping the cores awake shows the machine's share of its time.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing import get_context


@contextmanager
def awake_cores() -> Iterator[None]:
    """Run a loop on each core in the idle scheduling class (Linux: `SCHED_IDLE`)."""
    cores = os.sched_getaffinity(0)
    context = get_context("spawn")
    barrier = context.Barrier(len(cores) + 1)
    loops = [context.Process(target=_loop, args=(core, barrier), daemon=True) for core in cores]
    for process in loops:
        process.start()
    barrier.wait()
    try:
        yield
    finally:
        for process in loops:
            process.kill()
            process.join()


def _loop(core: int, barrier: threading.Barrier) -> None:
    os.sched_setaffinity(0, {core})
    os.sched_setscheduler(0, os.SCHED_IDLE, os.sched_param(0))
    barrier.wait()
    while True:
        pass
