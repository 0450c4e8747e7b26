"""A system that other hosts can reach requires certificates, or the option --insecure."""

from __future__ import annotations

import os

import pytest

from semmap.nodes import bus
from semmap.nodes.extern.cli.app import execute
from semmap.nodes.identity import authority


@pytest.fixture(scope="module")
def keys(tmp_path_factory):
    folder = tmp_path_factory.mktemp("keys") / "K"
    authority.init(folder)
    return folder


@pytest.fixture
def up(tmp_path, capsys):
    """The status and the complaint of `semmap up` with a world that is not there, which ends it."""

    def run(*words):
        status = execute(["up", "--data", str(tmp_path), "--world", "nothing.xml", *map(str, words)])
        return status, capsys.readouterr().err

    return run


@pytest.fixture
def starting(monkeypatch):
    """What would be started."""
    started = []
    monkeypatch.setattr("semmap.nodes.supervisor.up.up", lambda settings, say: started.append(settings))
    return started


@pytest.mark.parametrize(
    "listen", ["tcp/0.0.0.0:7447", "tcp/[::]:7447", "tcp/192.168.1.2:7447", "udp/robot:7447"]
)
def test_beyond_this_machine_it_takes_certificates(starting, capsys, listen):
    assert execute(["up", "--listen", listen]) == 2
    assert "--secure DIR" in capsys.readouterr().err
    assert execute(["up", "--listen", listen, "--insecure"]) == 0
    assert "can read and change the map" in capsys.readouterr().err
    assert [settings.listen for settings in starting] == [listen]


@pytest.mark.parametrize(
    "listen",
    [
        "tcp/127.0.0.1:7001",
        "tcp/localhost:7001",
        "tcp/[::1]:7001",
        "unixsock-stream//tmp/x",
        "udp/127.1.2.3:1",
    ],
)
def test_on_this_machine_it_does_not(starting, capsys, listen):
    assert execute(["up", "--listen", listen]) == 0
    assert capsys.readouterr().err == ""
    assert starting[0].secure is None


@pytest.mark.parametrize("host", ["127.0.0.1.evil.org", "localhost.evil.org", "1270.0.0.1", "12.7.0.0"])
def test_what_only_looks_like_loopback_is_not(host):
    assert not bus.is_local(f"tcp/{host}:7447")


def test_a_secure_system_listens_with_tls(starting, keys):
    assert execute(["up", "--secure", str(keys), "--listen", "tcp/0.0.0.0:7001"]) == 0
    (settings,) = starting
    assert settings.listen == "tls/0.0.0.0:7001"
    assert settings.nodes[0] == "router"
    listening = {node for node in settings.nodes if settings.network(node).listen}
    assert listening == {"router"}
    assert {settings.network(node).identity.name for node in settings.nodes} == set(settings.nodes)


def test_what_the_certificate_is_not_for_is_reported(starting, keys, capsys):
    assert execute(["up", "--secure", str(keys), "--listen", "tls/10.1.2.3:7001"]) == 2
    assert "semmap keys renew router --host 10.1.2.3" in capsys.readouterr().err


def test_what_does_not_go_together_is_reported(starting, keys, capsys):
    assert execute(["up", "--secure", str(keys), "--insecure"]) == 2
    assert "--secure and --insecure exclude each other" in capsys.readouterr().err


def test_a_folder_without_keys_is_reported(starting, tmp_path, capsys):
    assert execute(["up", "--secure", str(tmp_path)]) == 2
    assert f"semmap keys init {tmp_path}" in capsys.readouterr().err


def test_a_missing_certificate_is_reported_immediately(capsys):
    assert execute(["list", "--connect", "tls/127.0.0.1:1"]) == 3
    assert "--identity DIR/NAME" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("identity", "told"),
    [("unknown", "there is no file"), ("ca", "is not an identity: the certificate has no role")],
)
def test_an_invalid_identity_is_reported(keys, capsys, identity, told):
    assert execute(["list", "--identity", str(keys / identity)]) == 2
    said = capsys.readouterr().err
    assert told in said
    assert str(keys / identity) in said


def test_an_expired_certificate_of_the_systems_own_is_reported_before_the_start(starting, tmp_path, capsys):
    authority.init(tmp_path / "K", days=0)
    assert execute(["up", "--secure", str(tmp_path / "K")]) == 3
    assert "semmap keys renew supervisor" in capsys.readouterr().err
    assert starting == []


def test_a_node_may_join_a_router_elsewhere(keys, tmp_path, monkeypatch):
    ran = []
    monkeypatch.setattr(
        "semmap.nodes.supervisor.launch.run_node", lambda name, settings: ran.append((name, settings))
    )
    words = ["--secure", str(keys), "--connect", "tcp/robot1.local:7447", "--data", str(tmp_path)]
    mask = os.umask(0o022)
    try:
        assert execute(["node", "recorder", *words]) == 0
    finally:
        os.umask(mask)
    ((name, settings),) = ran
    network = settings.network(name)
    assert (network.connect, network.listen) == (("tls/robot1.local:7447",), ())
    assert network.identity.name == "recorder"


@pytest.mark.parametrize(
    "endpoint", ["udp/0.0.0.0:7447", "unixsock-stream//tmp/x", "tls/localhost:1#enable_mtls=false"]
)
def test_certificates_are_shown_over_tls_only(starting, keys, capsys, endpoint):
    assert execute(["up", "--secure", str(keys), "--listen", endpoint]) == 2
    assert "is not a plain TLS endpoint" in capsys.readouterr().err
    assert execute(["list", "--identity", str(keys / "recorder"), "--connect", endpoint]) == 2
    assert "is not a plain TLS endpoint" in capsys.readouterr().err
