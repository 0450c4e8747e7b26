"""A standing query of one tab: received on its own thread, and delivered on the event loop."""

from __future__ import annotations

import asyncio
import contextlib
import threading
from collections.abc import Callable

from semmap.nodes.extern.sparql_client import StandingQuery
from semmap.schemas import errors
from semmap.schemas.sparql import RowsChanged


class QuerySubscription:
    """The subscription to a standing query, until it is closed."""

    def __init__(
        self, query: StandingQuery, end: Callable[[], None], listener: Callable[[RowsChanged | str], None]
    ) -> None:
        """`listener` is called on the event loop with each change, or with the error that ended the query.

        `end` ends the query.
        """
        self._query = query
        self._end = end
        self._listener = listener
        self._loop = asyncio.get_running_loop()
        self._is_closed = False
        threading.Thread(target=self._wait, name="standing query", daemon=True).start()

    def close(self) -> None:
        """End the query without waiting for the system."""
        if not self._is_closed:
            self._is_closed = True
            threading.Thread(target=self._end, name="standing query ends", daemon=True).start()

    def _wait(self) -> None:
        try:
            for change in self._query.changes():
                self._post(change)
        except errors.SemmapError as error:
            self._post(error.text)

    def _post(self, change: RowsChanged | str) -> None:
        with contextlib.suppress(RuntimeError):  # the loop has ended
            self._loop.call_soon_threadsafe(self._deliver, change)

    def _deliver(self, change: RowsChanged | str) -> None:
        if not self._is_closed:
            self._listener(change)
