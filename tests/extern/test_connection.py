"""The way to a system that is there, is starting, or is not."""

import contextlib
import os
import re
import tempfile
import threading
import time

import pytest

from nodes import bus
from nodes.extern import connection
from nodes.extern.client import connect
from nodes.extern.connection import open_session
from nodes.supervisor import presence, registry
from schemas import errors
from tests.conftest import free_endpoint


@pytest.fixture
def running(monkeypatch, tmp_path):
    """Enter systems at these ports in a registry of our own."""
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    monkeypatch.setenv(connection.CONNECT_VARIABLE, "")

    @contextlib.contextmanager
    def enter(*ports):
        with contextlib.ExitStack() as stack:
            for port in ports:
                where = f"tcp/127.0.0.1:{port}"
                folder = tmp_path / str(port)
                stack.enter_context(
                    registry.entered(data=folder, listen=where, reachable=where, pid=os.getpid())
                )
            yield

    return enter


def test_the_system_that_is_meant(monkeypatch, running, tmp_path):
    assert connection.endpoint() == bus.DEFAULT_ENDPOINT
    with running(7801):
        assert connection.endpoint() == "tcp/127.0.0.1:7801"
        monkeypatch.setenv(connection.CONNECT_VARIABLE, "tcp/robot:7000")
        assert connection.endpoint() == "tcp/robot:7000"
    monkeypatch.setenv(connection.CONNECT_VARIABLE, "")
    with running(7801, 7447):
        assert connection.endpoint() == bus.DEFAULT_ENDPOINT
    both = f"tcp/127.0.0.1:7801 ({tmp_path}/7801), tcp/127.0.0.1:7802 ({tmp_path}/7802)"
    with running(7801, 7802), pytest.raises(errors.BadRequest, match=re.escape(both)):
        connection.endpoint()


def test_a_refused_connection_is_told_at_once():
    start_s = time.monotonic()
    with pytest.raises(errors.NoAnswer, match="start one with: semmap up"), open_session(free_endpoint(), ""):
        pass
    assert time.monotonic() - start_s < bus.PATIENCE_S / 2


def test_a_system_that_is_starting_is_waited_for():
    endpoint = free_endpoint()
    listening, done = threading.Event(), threading.Event()

    def listen_late() -> None:
        time.sleep(0.5)
        with bus.open_session(bus.Network(mode="peer", connect=(), listen=(endpoint,))):
            listening.set()
            done.wait()

    coordinator = threading.Thread(target=listen_late)
    with presence.announced(endpoint):
        coordinator.start()
        try:
            with open_session(endpoint, ""):
                assert listening.is_set()
        finally:
            done.set()
            coordinator.join()


def test_a_system_that_does_not_come_is_said_to_be_starting(monkeypatch):
    monkeypatch.setattr(connection, "_START_S", 0.2)
    endpoint = free_endpoint()
    with (
        presence.announced(endpoint),
        pytest.raises(errors.NoAnswer, match=f"the system at {endpoint} has not started yet"),
        open_session(endpoint, ""),
    ):
        pass


@pytest.mark.parametrize(("mode", "is_peer"), [("client", False), ("peer", True), (None, True)])
def test_a_session_joins_as_it_is_told(mode, is_peer):
    where = free_endpoint()
    there = bus.Network(connect=(), listen=(where,), mode="peer")
    with bus.open_session(there) as listening, connect(where, mode=mode) as client:
        zid = client.session.info.zid()
        deadline_s = time.monotonic() + 5.0
        while (zid in listening.info.peers_zid()) != is_peer and time.monotonic() < deadline_s:
            time.sleep(0.01)
        assert (zid in listening.info.peers_zid()) == is_peer
