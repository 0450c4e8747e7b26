"""A standing query of one tab: followed on a thread of its own, told of on the event loop."""

from __future__ import annotations

import asyncio
import contextlib
import threading
from collections.abc import Callable

from semmap.nodes.extern.sparql_client import StandingQuery
from semmap.schemas import errors
from semmap.schemas.sparql import RowsChanged


class Following:
    """Follows a standing query until it is closed."""

    def __init__(
        self, query: StandingQuery, end: Callable[[], None], told: Callable[[RowsChanged | str], None]
    ) -> None:
        """`told` is called on the event loop with each change, or with the sentence with which it ended.

        `end` ends the query.
        """
        self._query = query
        self._end = end
        self._told = told
        self._loop = asyncio.get_running_loop()
        self._is_closed = False
        threading.Thread(target=self._wait, name="standing query", daemon=True).start()

    def close(self) -> None:
        """End it, without waiting for anybody."""
        if not self._is_closed:
            self._is_closed = True
            threading.Thread(target=self._end, name="standing query ends", daemon=True).start()

    def _wait(self) -> None:
        try:
            for news in self._query.changes():
                self._tell(news)
        except errors.SemmapError as error:
            self._tell(error.text)

    def _tell(self, news: RowsChanged | str) -> None:
        with contextlib.suppress(RuntimeError):  # the loop has ended
            self._loop.call_soon_threadsafe(self._take, news)

    def _take(self, news: RowsChanged | str) -> None:
        if not self._is_closed:
            self._told(news)
