"""Announcement of a system that does not listen yet."""

import subprocess
import sys

import pytest

from semmap.nodes.supervisor import presence
from tests.conftest import free_endpoint


def test_an_endpoint_is_announced_until_the_end_also_by_two():
    endpoint = free_endpoint()
    assert not presence.is_announced(endpoint)
    with presence.announced(endpoint):
        with presence.announced(endpoint):
            assert presence.is_announced(endpoint)
            assert presence.is_announced(endpoint.replace("127.0.0.1", "localhost"))
        assert presence.is_announced(endpoint)
        assert not presence.is_announced(free_endpoint())
        assert not presence.is_announced(endpoint.replace("127.0.0.1", "[::1]"))
    assert not presence.is_announced(endpoint)


def test_leftover_files_announce_nothing():
    endpoint = free_endpoint()
    code = f"""if True:
        import os
        from semmap.nodes.supervisor import presence
        with presence.announced({endpoint!r}):
            print(presence.is_announced({endpoint!r}), flush=True)
            os._exit(1)
    """
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout == "True\n"
    assert not presence.is_announced(endpoint)
    with presence.announced(endpoint):
        assert presence.is_announced(endpoint)


@pytest.mark.parametrize("endpoint", ["tcp/10.0.0.1:7447", "udp/127.0.0.1:7447", "unixsock-stream//tmp/x"])
def test_other_endpoints_are_not_announced(endpoint):
    assert not presence.is_loopback(endpoint)
    with presence.announced(endpoint):
        assert not presence.is_announced(endpoint)
