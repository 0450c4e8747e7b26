"""Memory of a process: pauses of garbage collection, and return of free memory to the system."""

from __future__ import annotations

import contextlib
import ctypes
import gc
from collections.abc import Iterator
from contextlib import contextmanager

_MANY = 100_000


@contextmanager
def uncollected(*, freeze: bool = False) -> Iterator[None]:
    """Pause garbage collection; objects created in the meantime are assumed to stay.

    A collection over millions of objects would stop the whole process, including Zenoh's keep-alive, for
    longer than a lease. If there are many new objects, or with `freeze`, all present objects are therefore
    frozen.
    """
    was_on = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_on:
            if freeze or gc.get_count()[0] > _MANY:
                gc.freeze()
            gc.enable()


def trim() -> None:
    """Return free memory to the system; takes milliseconds.

    Work on a large map leaves a third of the process's memory fragmented. Only glibc can release it;
    elsewhere this does nothing.
    """
    with contextlib.suppress(OSError, AttributeError):
        ctypes.CDLL(None).malloc_trim(0)
