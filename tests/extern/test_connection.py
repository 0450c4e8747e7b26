"""Connections to a system that is running, starting, or absent."""

import contextlib
import os
import re
import tempfile
import threading

import pytest

from semmap.nodes import bus
from semmap.nodes.extern import connection
from semmap.nodes.extern.client import connect
from semmap.nodes.extern.connection import open_session
from semmap.nodes.supervisor import presence, registry
from semmap.schemas import errors
from tests.conftest import PATIENCE_S, free_endpoint, until


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
    both = f"tcp/127.0.0.1:7801 ({tmp_path}/7801) and tcp/127.0.0.1:7802 ({tmp_path}/7802)"
    with running(7801, 7802), pytest.raises(errors.BadRequest, match=re.escape(both)):
        connection.endpoint()
    with running(*range(7801, 7809)), pytest.raises(errors.BadRequest, match=r" and 4 more$"):
        connection.endpoint()


@pytest.fixture
def tried(monkeypatch):
    """How long each attempt to open a session was to go on [s]."""
    attempts = []

    def noted(network):
        attempts.append(network.patience_s)
        return opened(network)

    opened = bus.open_session
    monkeypatch.setattr(bus, "open_session", noted)
    return attempts


def test_a_refused_connection_is_reported_at_once(tried):
    with (
        pytest.raises(errors.NoAnswer, match="start a system with: semmap up"),
        open_session(free_endpoint(), ""),
    ):
        pass
    assert tried == [0.0]


def test_a_system_that_is_starting_is_waited_for(tried, monkeypatch):
    monkeypatch.setattr(connection, "_START_S", PATIENCE_S)
    endpoint = free_endpoint()
    done = threading.Event()

    def listen_late() -> None:
        until(lambda: len(tried) > 1, "the client has tried without success")
        with bus.open_session(bus.Network(mode="peer", connect=(), listen=(endpoint,))):
            done.wait(PATIENCE_S)

    coordinator = threading.Thread(target=listen_late)
    with presence.announced(endpoint):
        coordinator.start()
        try:
            with open_session(endpoint, ""):
                assert tried[:2] == [0.0, 0.0]
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


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        ({"where": 7447}, "'7447' is not a valid endpoint; use tcp/HOST:PORT"),
        ({"where": "tcp/robot:7447", "namespace": 5}, "'5' is not a valid robot name"),
        ({"where": "tcp/robot:7447", "identity": 5}, "there is no file 5.crt"),
        ({"where": "tcp/robot:7447", "mode": "router"}, "'router' is not a mode of a session; use peer"),
    ],
)
def test_arguments_of_another_type_are_rejected_before_a_connection(arguments, reason):
    with pytest.raises(errors.BadRequest, match=reason), connect(**arguments):
        pass


@pytest.mark.parametrize(("mode", "is_peer"), [("client", False), ("peer", True), (None, True)])
def test_the_mode_of_a_session(mode, is_peer):
    where = free_endpoint()
    there = bus.Network(connect=(), listen=(where,), mode="peer")
    with bus.open_session(there) as listening, connect(where, mode=mode) as client:
        zid = client.session.info.zid()
        there = until(lambda: [t for t in listening.info.transports() if t.zid == zid], "the session")
        assert (str(there[0].whatami) == "peer") == is_peer
