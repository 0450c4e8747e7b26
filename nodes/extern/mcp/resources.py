"""The resources: the schema for queries, and standing queries, which notify subscribers of changes.

The URI of a standing query is `semmap://watch/in/kitchen1`, `on/table1`, `near/cup1`, `class/Cup`, or
`query/` with a percent-encoded SELECT.
"""

from __future__ import annotations

import re
import threading
from collections.abc import Callable
from contextlib import ExitStack
from typing import Any, Final, NamedTuple
from urllib.parse import unquote

from semmap.nodes.extern.client import Client
from semmap.nodes.extern.mcp import answers, rows
from semmap.nodes.extern.mcp.answers import Answer
from semmap.nodes.extern.mcp.consistent_read import newest
from semmap.ontology.prefixes import WELL_KNOWN
from semmap.schemas import errors

SCHEMA: Final = "semmap://schema"
CLASSES: Final = f"{SCHEMA}/classes"
PROPERTIES: Final = f"{SCHEMA}/properties"
WATCH: Final = "semmap://watch/"
KINDS: Final = ("in", "on", "near", "class", "query")
_CLASS: Final = re.compile(r"[\w.-]{1,200}")
MOST: Final = 20
"""The maximum number of standing queries of one server."""


def read(client: Client, uri: str) -> str:
    """Return the content of a resource, as JSON of at most 4 000 characters. Raises SemmapError."""
    if uri == SCHEMA:
        return answers.text(_schema(client))
    for page, of in ((CLASSES, _classes), (PROPERTIES, _properties)):
        if uri == page or uri.startswith(f"{page}/"):
            cursor = uri.removeprefix(page).removeprefix("/")
            return answers.text(of(client), answers.read_cursor(cursor)[1] if cursor else 0)
    if uri.startswith(WATCH):
        with client.watch(**watch_arguments(uri)) as standing:
            found = [rows.solution(row) for row in standing.rows]
            head = {"variables": standing.variables}
            return answers.text(
                Answer(first=standing.seq, last=standing.seq, head=head, items=found, of="rows")
            )
    raise errors.Refused(
        f"unknown resource; available: {SCHEMA}, {CLASSES}, {PROPERTIES} and {WATCH}KIND/WORD"
    )


def watch_arguments(uri: str) -> dict[str, Any]:
    """Return the arguments of `Client.watch` for the URI of a standing query. Raises BadRequest."""
    kind, _, word = uri.removeprefix(WATCH).partition("/")
    word = unquote(word)
    if kind not in KINDS or not word:
        raise errors.BadRequest(f"use {WATCH}KIND/WORD, where KIND is {errors.enumerated(KINDS)}")
    if kind == "query":
        return {"query": word, "inferred": True}
    if kind == "class":
        if not _CLASS.fullmatch(word):
            raise errors.BadRequest(f"'{word[:100]}' is not a class name; example: {WATCH}class/Cup")
        return {"query": f"SELECT ?entity {{ ?entity a <{WELL_KNOWN['dm']}{word}> }}", "inferred": True}
    return {"in_" if kind == "in" else kind: word}


def _schema(client: Client) -> Answer:
    seq = newest(client)
    head = {
        "prefixes": dict(WELL_KNOWN),
        "classes": f"{CLASSES}, by pages: {CLASSES}/NEXT",
        "properties": f"{PROPERTIES}, by pages: {PROPERTIES}/NEXT",
        "measured": [f"dm:{name}" for name in rows.PLACED],
        "example": "SELECT ?e ?p { ?e a dm:Cup ; dm:isLocatedIn ?p }",
    }
    return Answer(first=seq, last=seq, head=head)


def _classes(client: Client) -> Answer:
    """Return the classes with their parents: `Cup < Drinking_Vessel`."""
    found = [
        f"{info.prefixed or info.name} < {', '.join(info.parents)}" if info.parents else info.name
        for info in client.classes()
    ]
    return _listed(client, found, "classes")


def _properties(client: Client) -> Answer:
    """Return the properties with domain and range: `isOpen: Door -> boolean`."""
    found = [
        f"{info.name}: {', '.join(info.domain) or 'anything'} -> {', '.join(info.range) or 'anything'}"
        for info in client.properties()
    ]
    return _listed(client, found, "properties")


def _listed(client: Client, found: list[str], of: str) -> Answer:
    seq = newest(client)
    return Answer(first=seq, last=seq, head={}, items=found, of=of)


class _Subscription(NamedTuple):
    subscribers: int
    end: Callable[[], None]


class Subscriptions:
    """The subscriptions of one server. They can be used from any thread."""

    def __init__(self, client: Callable[[], Client], changed: Callable[[str], None]) -> None:
        """Set up; `changed(uri)` is called on a separate thread when the result of a query changes.

        `client()` returns the client.
        """
        self._client = client
        self._changed = changed
        self._lock = threading.Lock()
        self._active: dict[str, _Subscription] = {}

    def subscribe(self, uri: str) -> None:
        """Add a subscriber. URIs that are not standing queries never change. Raises SemmapError."""
        if not uri.startswith(WATCH):
            return
        arguments = watch_arguments(uri)
        with self._lock:
            if (known := self._active.get(uri)) is not None:
                self._active[uri] = known._replace(subscribers=known.subscribers + 1)
                return
            if len(self._active) >= MOST:
                raise errors.Refused(f"limit of {MOST} standing queries reached; unsubscribe from one first")
            stack = ExitStack()
            standing = stack.enter_context(self._client().watch(**arguments))
            self._active[uri] = _Subscription(1, stack.close)

        def wait() -> None:
            try:
                for _ in standing.changes():
                    self._changed(uri)
            except errors.SemmapError:
                self._changed(uri)  # the next read returns the error

        threading.Thread(target=wait, name="standing query", daemon=True).start()

    def unsubscribe(self, uri: str) -> None:
        """Remove a subscriber; without subscribers, the query ends."""
        with self._lock:
            known = self._active.get(uri)
            if known is None:
                return
            if known.subscribers > 1:
                self._active[uri] = known._replace(subscribers=known.subscribers - 1)
                return
            del self._active[uri]
        known.end()

    def close(self) -> None:
        """End all queries."""
        with self._lock:
            ending, self._active = list(self._active.values()), {}
        for subscription in ending:
            subscription.end()
