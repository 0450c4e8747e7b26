"""Opening a session."""

from __future__ import annotations

import pytest

from semmap.nodes import bus
from semmap.schemas import errors


@pytest.mark.parametrize("endpoint", ["nonsense", "tcp/", "udp7/127.0.0.1:1"])
def test_a_malformed_endpoint_is_an_error(endpoint):
    with (
        pytest.raises((errors.BadRequest, errors.NoAnswer), match=endpoint),
        bus.open_session(bus.Network(connect=(endpoint,), patience_s=0.0)),
    ):
        pass
