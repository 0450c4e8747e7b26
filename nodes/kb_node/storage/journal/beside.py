"""A second thread for what can be worked out while the disk takes something."""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

Work = Callable[[], Any]


class Beside:
    """One thread, which lives from the first piece of work until `close`, and works while its owner waits.

    Its owner waits in a call that lets go of Python's lock, as those of SQLite do, and touches nothing that
    the work touches. So all that belongs to one thread still does: to whichever of the two is not waiting.
    """

    def __init__(self) -> None:
        self._work: queue.SimpleQueue[Work | None] = queue.SimpleQueue()
        self._done: queue.SimpleQueue[BaseException | None] = queue.SimpleQueue()
        self._thread: threading.Thread | None = None

    @contextmanager
    def doing(self, work: Work) -> Iterator[None]:
        """Within the block `work()` is done as well; it has ended when the block has.

        Raises what the block raises, or else what `work` raises.
        """
        if self._thread is None:
            self._thread = threading.Thread(target=self._run, name="beside", daemon=True)
            self._thread.start()
        self._work.put(work)
        try:
            yield
        finally:
            error = self._done.get()
        if error is not None:
            raise error

    def close(self) -> None:
        """End the thread."""
        if self._thread is not None:
            self._work.put(None)
            self._thread.join()
            self._thread = None

    def _run(self) -> None:
        while (work := self._work.get()) is not None:
            try:
                work()
            except BaseException as error:
                self._done.put(error)
            else:
                self._done.put(None)
            del work
