"""Ports that are taken."""

from __future__ import annotations

import socket
import subprocess
import sys
from types import SimpleNamespace

import pytest

from semmap.nodes.supervisor import ports
from semmap.schemas import errors


@pytest.fixture
def taken():
    with socket.socket() as listening:
        listening.bind(("127.0.0.1", 0))
        listening.listen()
        yield listening.getsockname()[1]


def system(endpoint):
    return ports.registry.System(
        data="/maps/my lab", listen=endpoint, reachable=endpoint, pid=1, started="now"
    )


@pytest.mark.parametrize(
    ("is_known", "cause"),
    [
        (
            True,
            "the system of /maps/my lab listens there; stop it (semmap down --data '/maps/my lab'), or use",
        ),
        (False, "Address already in use; use"),
    ],
)
def test_an_endpoint_in_use_is_reported_with_the_system_that_uses_it(monkeypatch, taken, is_known, cause):
    known = f"tcp/127.0.0.1:{taken if is_known else taken + 1}"
    monkeypatch.setattr(ports.registry, "systems", lambda: (system(known),))
    with pytest.raises(errors.Refused) as caught:
        ports.require_free(f"tcp/127.0.0.1:{taken}")
    assert caught.value.text == (
        f"cannot listen on tcp/127.0.0.1:{taken}: {cause} another endpoint, for example"
        f" --listen tcp/127.0.0.1:{taken + 1}"
    )


def test_a_taken_port_of_the_page_is_reported_and_0_is_any_free_one(taken):
    with pytest.raises(errors.Refused, match=f"cannot listen on 127.0.0.1:{taken}: .*--web-port"):
        ports.find_web_port(taken)
    assert ports.find_web_port(0) not in (0, taken)


def test_the_live_view_has_another_port_if_its_own_is_taken(monkeypatch, taken):
    monkeypatch.setattr(ports, "_LIVE_PORT", taken)
    host, _, port = ports.find_live_view().partition(":")
    assert (host, int(port) != taken) == ("127.0.0.1", True)


def test_a_free_port_is_given_to_one_process_only_before_anything_listens_there(monkeypatch):
    draw = (
        "from semmap.nodes.supervisor.ports import free_endpoint; print(free_endpoint(), flush=True); input()"
    )
    with subprocess.Popen(
        [sys.executable, "-c", draw], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as other:
        ours, theirs = port_of(ports.free_endpoint()), port_of(other.stdout.readline())
        draws = iter([ours, theirs, *range(ours + 1, ports._AFTER_PORTS)])
        monkeypatch.setattr(ports, "_dice", SimpleNamespace(randrange=lambda *_: next(draws)))
        assert port_of(ports.free_endpoint()) not in (ours, theirs)
        other.communicate("\n")


def port_of(endpoint):
    return int(endpoint.rpartition(":")[2])
