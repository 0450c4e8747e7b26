"""The start and end of `semmap mcp`, without a system."""

import signal
from types import SimpleNamespace

import pytest

from semmap.nodes import bus
from semmap.nodes.extern import connection
from semmap.nodes.extern.cli.commands import mcp
from semmap.schemas import errors


def failing(error):
    def client():
        raise error

    client.connected = None
    return client


def test_a_system_that_is_not_running_is_waited_for(capsys):
    mcp._check(failing(errors.NoAnswer("no response from here")), None, tuple)
    assert capsys.readouterr().err == "note: no response from here; the tools wait for it\n"


def test_a_system_that_rejects_the_client_is_not_waited_for():
    with pytest.raises(bus.ConnectionClosed):
        mcp._check(failing(bus.ConnectionClosed("requires a client certificate")), None, tuple)
    with (
        pytest.raises(bus.ConnectionClosed, match="add --identity DIR/NAME"),
        connection.open_session("tls/127.0.0.1:7999", ""),
    ):
        pass


def test_the_note_lists_the_robots_that_are_there(capsys):
    def no_answer(_):
        raise errors.NoAnswer("no response on kb")

    client = lambda: client  # noqa: E731
    client.connected = client
    mcp._check(client, SimpleNamespace(check_limits=no_answer), lambda: ("r1", "r2"))
    assert capsys.readouterr().err == (
        "note: no response on kb; available robots: r1, r2; the tools wait for it\n"
    )


def test_the_requests_are_withdrawn_when_the_process_is_terminated_or_ends(monkeypatch):
    events = []
    monkeypatch.setattr(signal, "raise_signal", lambda number: events.append(signal.getsignal(number)))
    before = signal.getsignal(signal.SIGTERM)
    client = SimpleNamespace(connected="a client")
    with mcp._withdrawing_requests(client, SimpleNamespace(withdraw_requests=events.append)):
        signal.getsignal(signal.SIGTERM)(signal.SIGTERM, None)
        assert events == ["a client", signal.SIG_DFL]
    assert events == ["a client", signal.SIG_DFL, "a client"]
    assert signal.getsignal(signal.SIGTERM) == before
