import contextlib

import pytest

from semmap.nodes.extern.mcp.lazy_client import LazyClient
from semmap.schemas import errors


def test_it_is_connected_once_as_soon_as_there_is_a_system():
    events, up, now_s = [], False, 0.0

    @contextlib.contextmanager
    def connect():
        if not up:
            raise errors.NoAnswer("no system")
        events.append("connected")
        yield "a client"
        events.append("closed")

    client = LazyClient(connect, lambda: now_s)
    with pytest.raises(errors.NoAnswer):
        client()
    assert client.connected is None
    up, now_s = True, 1.1
    assert client() == client() == client.connected == "a client"
    client.close()
    assert events == ["connected", "closed"]


def test_a_failed_attempt_is_that_of_all_calls_that_have_waited_for_it():
    attempts, now_s = [], 0.0

    def connect():
        nonlocal now_s
        attempts.append(now_s)
        now_s += 3.0  # as a remote endpoint takes
        raise errors.NoAnswer("no system")

    client = LazyClient(connect, lambda: now_s)
    for _ in range(8):
        with pytest.raises(errors.NoAnswer, match="no system"):
            client()
    now_s += 1.1
    with pytest.raises(errors.NoAnswer, match="no system"):
        client()
    assert attempts == [0.0, 4.1]


def test_it_does_not_connect_after_it_is_closed():
    client = LazyClient(lambda: contextlib.nullcontext("a client"))
    client.close()
    with pytest.raises(errors.NoAnswer, match="has ended"):
        client()
    assert client.connected is None
