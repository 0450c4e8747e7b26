"""When no garbage is collected: a large change of the map makes many objects, and drops few."""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager

_MANY = 100_000


@contextmanager
def uncollected(*, freeze: bool = False) -> Iterator[None]:
    """No garbage is collected meanwhile, and what was made is taken to stay.

    Looking through millions of objects would stop the whole process, Zenoh's keep-alive included, for longer
    than a lease. So when there are many new ones, or with `freeze`, all that are there by then are frozen.
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
