"""Connections end when nothing is acknowledged."""

import socket
import sys

import pytest

from semmap.nodes.router.tcp_timeout import set_user_timeout


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere there is no such option")
def test_every_connection_of_the_process_gets_the_time_out():
    option = socket.TCP_USER_TIMEOUT
    with socket.create_server(("127.0.0.1", 0)) as server, socket.socket(socket.AF_UNIX) as other:
        with socket.create_connection(server.getsockname()) as one:
            assert one.getsockopt(socket.IPPROTO_TCP, option) == 0
            assert set_user_timeout(2.5) >= 2
            assert one.getsockopt(socket.IPPROTO_TCP, option) == 2500
            one.sendall(b"still open")
        other.bind("")  # is as it was
