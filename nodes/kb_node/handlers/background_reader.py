"""Work on documents beside the node: in a thread that calls another process."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Final, TypeVar

from semmap.nodes.kb_node.documents.isolated_parser import IsolatedParser
from semmap.nodes.runtime.futures import settle
from semmap.schemas import errors

_MOST_READ: Final = 8
"""Documents that are read in the other process, or wait for it."""
_AGAIN_S: Final = 5.0
T = TypeVar("T")
R = TypeVar("R")


class BackgroundReader:
    """Reads documents and computes closures of ontologies while the node serves other requests."""

    def __init__(self, run_soon: Callable[[Callable[[], None]], None]) -> None:
        """`run_soon(function)` calls a function on the thread of the map."""
        self.parser = IsolatedParser()
        self._run_soon = run_soon
        self._aside = ThreadPoolExecutor(1, "reading")
        self._waiting = 0

    def close(self) -> None:
        """Stop reading documents. Those that are being read are rejected."""
        self._aside.shutdown(wait=False, cancel_futures=True)
        self.parser.close()

    def run(self, work: Callable[[], T], use: Callable[[T], R | Future[R]]) -> Future[R]:
        """Return the future `use(work())`. The node serves other requests while a thread executes `work`.

        Raises Busy if very many documents are being read.
        """
        if self._waiting == _MOST_READ:
            raise errors.Busy(
                f"{self._waiting} files are being read; try again in {_AGAIN_S:g} s", again_s=_AGAIN_S
            )
        self._waiting += 1
        loaded = Future[R]()

        def finish(done: Future[T]) -> None:
            self._waiting -= 1
            settle(loaded, lambda: use(done.result()))

        self._aside.submit(work).add_done_callback(lambda done: self._run_soon(lambda: finish(done)))
        return loaded
