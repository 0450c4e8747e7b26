"""Pauses garbage collection during large changes of the map, which create many objects."""

from __future__ import annotations

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
