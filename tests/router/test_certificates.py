"""Clients without a connection, and those whose connection carries nothing."""

from __future__ import annotations

import contextlib
import shutil
import socket
import ssl
from datetime import UTC, datetime, timedelta

import pytest
import zenoh
from msgspec import structs

from semmap.nodes import bus
from semmap.nodes.identity import Identity, authority
from semmap.schemas import errors, keys
from tests.conftest import PATIENCE_S, free_endpoint, until
from tests.router.conftest import opened


@pytest.fixture
def served(sessions):
    def answer(query):
        with query:
            query.reply(query.key_expr, "served")

    queryable = sessions["coordinator"].declare_queryable(f"{keys.commands_as()}/*", answer)
    until(lambda: asked(sessions["operator"], "operator") == ["served"], "an answer")
    yield
    queryable.undeclare()


def asked(session, name):
    return [r.ok.payload.to_string() for r in session.get(f"{keys.commands_as(name)}/get") if r.ok]


@pytest.fixture
def others(tmp_path):
    """The keys of another authority."""
    folder = tmp_path / "others"
    authority.init(folder)
    authority.add(folder, "operator", "operator")
    return folder


@pytest.fixture
def changed(folder, tmp_path):
    """A copy of the keys that the router does not use."""
    return shutil.copytree(folder, tmp_path / "changed")


def refused(endpoint, identity):
    with contextlib.ExitStack() as stack, pytest.raises(errors.SemmapError) as caught:
        opened(stack, endpoint, identity, patience_s=0.5)
    return caught.value


def test_a_certificate_of_another_authority_opens_nothing(endpoint, others):
    assert isinstance(refused(endpoint, Identity.read(others / "operator")), errors.NoAnswer)


def test_trusting_the_right_authority_with_anothers_certificate_opens_nothing(folder, endpoint, others):
    stranger = structs.replace(Identity.read(others / "operator"), authority=str(folder / "ca.crt"))
    assert isinstance(refused(endpoint, stranger), errors.NoAnswer)


def test_an_expired_certificate_opens_nothing(changed, endpoint):
    authority.add(changed, "late", "operator", days=0)
    assert isinstance(refused(endpoint, Identity.read(changed / "late")), errors.NoAnswer)


def test_no_certificate_opens_nothing(folder, endpoint):
    """With TLS 1.3, the error arrives after the client's own handshake, with the first message."""
    host, _, port = endpoint.removeprefix("tls/").rpartition(":")
    context = ssl.create_default_context(cafile=str(folder / "ca.crt"))
    with (
        socket.create_connection((host, int(port)), timeout=PATIENCE_S) as plain,
        context.wrap_socket(plain, server_hostname=host) as link,
        pytest.raises(ssl.SSLError, match=r"(?i)certificate.required"),
    ):
        link.recv(1)


def test_plain_tcp_opens_nothing(endpoint):
    assert isinstance(refused(endpoint.replace("tls/", "tcp/"), None), errors.NoAnswer)


def test_a_certificate_that_is_not_in_the_register_carries_nothing(changed, endpoint, served, sessions):
    """Like a revoked one: the authority is valid, so the connection opens."""
    authority.add(changed, "unheard-of", "admin")
    assert asked(sessions["operator"], "operator") == ["served"]
    with contextlib.ExitStack() as stack:
        session = opened(stack, endpoint, Identity.read(changed / "unheard-of"))
        assert asked(session, "unheard-of") == []
        assert asked(session, "operator") == []
        assert list(session.liveliness().get(keys.live_key("*"))) == []


@pytest.mark.parametrize("impostor", ["operator", "node", "kb_node"])
def test_only_the_router_can_be_a_server(folder, impostor):
    """A server with another certificate of the same authority is not accepted as the router."""
    endpoint = bus.to_tls(free_endpoint())
    posing = bus.Network(
        mode="router", listen=(endpoint,), connect=(), identity=Identity.read(folder / impostor)
    )
    with bus.open_session(posing):
        assert isinstance(refused(endpoint, Identity.read(folder / "viewer")), errors.NoAnswer)


def test_a_router_is_trusted_at_its_own_hosts_only(folder, endpoint):
    _, _, port = endpoint.rpartition(":")
    with contextlib.ExitStack() as stack:
        opened(stack, f"tls/localhost:{port}", Identity.read(folder / "viewer"))
    assert isinstance(refused(f"tls/127.0.0.2:{port}", Identity.read(folder / "viewer")), errors.NoAnswer)


def test_a_link_ends_when_the_certificate_expires(changed, folder, endpoint, served, monkeypatch):
    """A registered name with a certificate that is about to expire."""
    with contextlib.ExitStack() as stack:
        for seconds in (2, 4, 8, 16, 32):
            soon = datetime.now(UTC) + timedelta(seconds=seconds)
            with monkeypatch.context() as patched:
                patched.setattr(authority, "_end", lambda days, soon=soon: soon)
                authority.renew(changed, "viewer")
            viewer = Identity.read(changed / "viewer")
            with contextlib.suppress(errors.NoAnswer):  # on a busy machine it expires before it is used
                session = opened(stack, endpoint, viewer)
                if asked(session, "viewer") == ["served"]:
                    break
        until(lambda: asked(session, "viewer") == [], "the end of the link")
        assert datetime.now(UTC) > soon - timedelta(seconds=1)
        assert isinstance(refused(endpoint, viewer), errors.NoAnswer)
        assert asked(session, "viewer") == []


@pytest.mark.parametrize("victim", ["operator", "coordinator"])
def test_the_id_of_another_session_has_no_effect(folder, endpoint, served, sessions, victim):
    """Rules use certificates, and an id in use opens no second connection."""
    config = bus.Network(
        connect=(endpoint,), identity=Identity.read(folder / "viewer"), patience_s=0.5
    ).as_config()
    config.insert_json5("id", f'"{sessions[victim].zid()}"')
    with pytest.raises(zenoh.ZError), zenoh.open(config):
        pass
    assert asked(sessions["operator"], "operator") == ["served"]
