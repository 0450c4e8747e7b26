"""Publishes the row changes of standing queries, each with its own key and publisher."""

from __future__ import annotations

from typing import Any, Final

from msgspec import structs

from semmap.nodes import bus
from semmap.nodes.kb_node.sparql.protocol import QueryUpdate
from semmap.schemas import codec, keys

_TOO_MUCH: Final = f"result change larger than {bus.PUBLICATION_BYTES >> 20} MB; run the query again"


class RowPublisher:
    """Publishes row changes. Used by one thread."""

    def __init__(self, session: bus.Session) -> None:
        self._session = session
        self._publishers: dict[str, Any] = {}

    def publish(self, news: QueryUpdate) -> None:
        """Publish the row changes of a query; after its end, remove its publisher."""
        if news.rows is not None:
            if news.watch not in self._publishers:
                key = keys.query_key(news.watch)
                self._publishers[news.watch] = bus.publisher(self._session, keys.QUERY, key)
            rows = news.rows
            if len(payload := codec.encode(rows)) > bus.PUBLICATION_BYTES:
                rows = structs.replace(rows, appeared=(), disappeared=(), error=_TOO_MUCH)
                payload = codec.encode(rows)
            self._publishers[news.watch].put(payload, encoding=codec.encoding_of(rows))
        if news.ended and (publisher := self._publishers.pop(news.watch, None)) is not None:
            publisher.undeclare()
