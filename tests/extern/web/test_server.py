import logging

import pytest

from nodes import bus
from nodes.extern.testing import free_endpoint
from nodes.extern.web.server import WebConfig, _is_news, run
from schemas import errors


def record(error):
    known = None if error is None else (type(error), error, None)
    return logging.LogRecord("uvicorn.error", logging.ERROR, "here", 1, "in the application", (), known)


def test_a_tab_that_closes_while_it_is_answered_is_no_news():
    assert not _is_news(record(RuntimeError("No response returned.")))


@pytest.mark.parametrize("error", [None, RuntimeError("something else"), KeyError("No response returned.")])
def test_everything_else_is(error):
    assert _is_news(record(error))


def test_a_port_that_is_taken_is_told_before_anything_begins():
    endpoint = free_endpoint()
    with bus.open_session(bus.Network(connect=(), listen=(endpoint,), mode="peer")):
        taken = int(endpoint.rpartition(":")[2])
        with pytest.raises(
            errors.BadRequest, match=f"cannot listen on 127.0.0.1:{taken}: another program uses"
        ):
            run(WebConfig(network=bus.Network(connect=(endpoint,)), port=taken), print)
