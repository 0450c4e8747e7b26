import pytest

from nodes import bus
from nodes.extern.testing import free_endpoint
from nodes.extern.web.server import WebConfig, run
from schemas import errors


def test_a_port_that_is_taken_is_told_before_anything_begins():
    endpoint = free_endpoint()
    with bus.open_session(bus.Network(connect=(), listen=(endpoint,), mode="peer")):
        taken = int(endpoint.rpartition(":")[2])
        with pytest.raises(
            errors.BadRequest, match=f"cannot listen on 127.0.0.1:{taken}: another program uses"
        ):
            run(WebConfig(network=bus.Network(connect=(endpoint,)), port=taken), print)
