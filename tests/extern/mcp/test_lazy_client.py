import contextlib

import pytest

from semmap.nodes.extern.mcp.lazy_client import LazyClient
from semmap.schemas import errors


def test_it_is_connected_once_as_soon_as_there_is_a_system():
    events, up = [], False

    @contextlib.contextmanager
    def connect():
        if not up:
            raise errors.NoAnswer("no system")
        events.append("connected")
        yield "a client"
        events.append("closed")

    client = LazyClient(connect)
    with pytest.raises(errors.NoAnswer):
        client()
    assert client.connected is None
    up = True
    assert client() == client() == client.connected == "a client"
    client.close()
    assert events == ["connected", "closed"]
