"""Two sessions on loopback, one of which serves."""

from __future__ import annotations

import pytest

from semmap.nodes import bus
from semmap.schemas import errors
from tests.conftest import free_endpoint

PREFIX = "semmap/test"


@pytest.fixture
def pair():
    """Two peers, one listening and one connected to it."""
    endpoint = free_endpoint()
    with (
        bus.open_session(bus.Network(mode="peer", listen=(endpoint,), connect=())) as server,
        bus.open_session(bus.Network(connect=(endpoint,))) as client,
    ):
        yield server, client


def answer(handle):
    """Serve on the thread of the callback, which is sufficient for a test."""

    def receive(request: bus.Request) -> None:
        try:
            request.reply(handle(request))
        except errors.SemmapError as error:
            request.refuse(error)

    return receive
