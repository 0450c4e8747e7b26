"""Health reports to `semmap up` without the network."""

from __future__ import annotations

import os
import socket
import stat

import pytest

from semmap.nodes.runtime.notify import NOTIFY_VARIABLE, notify
from semmap.nodes.supervisor.notices import Notices
from semmap.schemas.health import Health

HEALTH = Health(node="kb_node", pid=1, started_ns=2, stamp_ns=3, state="ready", detail="x" * 1000)


@pytest.fixture
def notices(tmp_path, monkeypatch):
    path = tmp_path / "notices"
    monkeypatch.setenv(NOTIFY_VARIABLE, str(path))
    notices = Notices(path)
    yield notices
    notices.close()


def test_sent_reports_are_received(notices):
    notify(HEALTH)
    notify(HEALTH)
    assert list(notices.wait(1.0)) == [HEALTH, HEALTH]
    assert list(notices.wait(0.0)) == []


def test_only_this_user_may_send(notices):
    assert stat.S_IMODE(notices.path.stat().st_mode) == 0o600


def test_invalid_datagrams_are_dropped(notices):
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as sender:
        for said in (b"", b"hello", os.urandom(1000), b"\x81\xa4node\x01"):
            sender.sendto(said, str(notices.path))
    notify(HEALTH)
    assert list(notices.wait(1.0)) == [HEALTH]


def test_sending_never_waits(notices):
    for _ in range(5000):
        notify(HEALTH)
    notices.close()
    notify(HEALTH)


def test_without_a_supervisor_nothing_is_sent(monkeypatch):
    monkeypatch.delenv(NOTIFY_VARIABLE, raising=False)
    notify(HEALTH)
