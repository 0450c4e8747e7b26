"""Cores that do not fall asleep.

On a machine that is shared with others a core that sleeps is theirs, and whoever wakes on it finds its
caches gone. A command wakes threads some forty times, so how much of its time is the machine's is seen
best by keeping the cores awake.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing import get_context


@contextmanager
def awake_cores() -> Iterator[None]:
    """A loop on each core, of the class of processes (Linux: `SCHED_IDLE`) that give way to every other."""
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
