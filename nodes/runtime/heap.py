"""Returns free heap memory to the operating system."""

from __future__ import annotations

import contextlib
import ctypes


def trim() -> None:
    """Return free memory to the system; takes milliseconds.

    Work on a large map leaves a third of the process's memory fragmented. Only glibc can release it;
    elsewhere this does nothing.
    """
    with contextlib.suppress(OSError, AttributeError):
        ctypes.CDLL(None).malloc_trim(0)
