"""The news of standing queries on the wire: each has a key, and so a publisher, of its own."""

from __future__ import annotations

from typing import Any

from nodes import bus
from nodes.kb_node.sparql.protocol import News
from schemas import codec, keys


class NewsStand:
    """Publishes the news, from one thread."""

    def __init__(self, session: bus.Session) -> None:
        self._session = session
        self._publishers: dict[str, Any] = {}

    def publish(self, news: News) -> None:
        """Tell those who watch a query what has changed; after its end, take its publisher away."""
        if news.rows is not None:
            if news.watch not in self._publishers:
                key = keys.query_key(news.watch)
                self._publishers[news.watch] = bus.publisher(self._session, keys.QUERY, key)
            self._publishers[news.watch].put(codec.encode(news.rows), encoding=codec.encoding_of(news.rows))
        if news.ended and (publisher := self._publishers.pop(news.watch, None)) is not None:
            publisher.undeclare()
