"""Waits until subscribers and queryables are matched, before a test publishes or queries."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from semmap.nodes import bus
from semmap.schemas import keys
from tests.conftest import until


def until_followed(session: bus.Session, *key_exprs: str) -> None:
    """Wait until what this session publishes on each key reaches a subscriber.

    Zenoh drops a publication that no subscriber is known for.
    """
    for key_expr in key_exprs:
        publisher = session.declare_publisher(key_expr)
        until(lambda publisher=publisher: publisher.matching_status.matching, f"a subscriber of {key_expr}")
        publisher.undeclare()


def until_served(session: bus.Session, *key_exprs: str) -> None:
    """Wait until this session has a matching queryable for each key."""
    for key_expr in key_exprs:
        querier = session.declare_querier(key_expr)
        until(lambda querier=querier: querier.matching_status.matching, f"a queryable for {key_expr}")
        querier.undeclare()


def questions_asked(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Record the keys of all queries that nodes in this process send."""
    asked: list[str] = []
    ask_later = bus.ask_later

    def noted(session: bus.Session, prefix: str, verb: str, *args: Any, **options: Any) -> None:
        asked.append(f"{prefix}/{verb}")
        ask_later(session, prefix, verb, *args, **options)

    monkeypatch.setattr(bus, "ask_later", noted)
    return asked


def publications_kept(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """Record the messages of a topic after their delivery to subscribers."""
    kept: list[Any] = []
    follow = bus.follow

    def noted(
        session: bus.Session, topic: keys.Topic, receive: Callable[[str, Any], None], *ignored: Any
    ) -> Any:
        def receive_and_note(key: str, message: Any) -> None:
            receive(key, message)
            kept.append(message)

        return follow(session, topic, receive_and_note, *ignored)

    monkeypatch.setattr(bus, "follow", noted)
    return kept
