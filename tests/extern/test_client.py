"""The client before a system that keeps it waiting."""

import pytest

from nodes import bus
from nodes.extern.client import connect
from schemas import errors, keys
from tests.conftest import free_endpoint


def test_a_coordinator_that_is_too_busy_to_say_how_things_stand_is_told():
    endpoint, kept = free_endpoint(), []
    network = bus.Network(mode="peer", connect=(), listen=(endpoint,))
    with bus.open_session(network) as session, connect(endpoint) as client:
        queryable = session.declare_queryable(f"{keys.CMD}/*", kept.append)
        with pytest.raises(errors.NoAnswer, match=r"status did not answer within 0\.3 s"):
            client.status(timeout_s=0.3)
        queryable.undeclare()
    assert len(kept) == 1
