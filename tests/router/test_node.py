"""The router process: it follows the register, and all clients reconnect."""

from __future__ import annotations

import contextlib
import shutil
import signal
import subprocess
import sys
from datetime import UTC, datetime, timedelta

import pytest

from semmap.nodes import bus
from semmap.nodes.identity import Identity, authority
from semmap.nodes.identity.register import Member, Register
from semmap.nodes.router.node import describe_certificates
from semmap.nodes.supervisor.settings import Settings
from semmap.schemas import codec, keys
from semmap.schemas.commits import Effects
from semmap.schemas.health import Health
from tests.conftest import PATIENCE_S, free_endpoint, until
from tests.router.conftest import opened

_ANSWER_S = 5.0
"""A query that is on its way while the router restarts may never be answered."""


@pytest.fixture
def own(folder, tmp_path):
    """The keys of one test."""
    return shutil.copytree(folder, tmp_path / "K")


@pytest.fixture
def routed(own, tmp_path):
    """The endpoint of the router process."""
    endpoint = bus.to_tls(free_endpoint())
    settings = Settings(
        data=str(tmp_path), tbox="none", abox=None, world="none", listen=endpoint, secure=str(own)
    )
    path = tmp_path / "settings.json"
    path.write_bytes(codec.encode_json(settings))
    command = [sys.executable, "-P", "-m", "semmap.nodes.supervisor.launch", keys.ROUTER, str(path)]
    with subprocess.Popen(command) as process:
        yield endpoint
        process.send_signal(signal.SIGTERM)
        assert process.wait(PATIENCE_S) == 0


@pytest.fixture
def joined(own, routed):
    """Opens a session for a name."""
    with contextlib.ExitStack() as stack:
        yield lambda name: opened(stack, routed, Identity.read(own / name), patience_s=PATIENCE_S)


def asked(session, name):
    return [
        r.ok.payload.to_string()
        for r in session.get(f"{keys.commands_as(name)}/get", timeout=_ANSWER_S)
        if r.ok
    ]


def serve(session):
    def answer(query):
        with query:
            query.reply(query.key_expr, "served")

    session.declare_queryable(f"{keys.commands_as()}/*", answer)


def test_added_members_are_admitted_and_revoked_ones_rejected(own, joined):
    serve(joined("coordinator"))
    viewer = joined("viewer")
    until(lambda: asked(viewer, "viewer"), "an answer")
    authority.add(own, "bob", "operator")
    bob = joined("bob")
    until(lambda: asked(bob, "bob"), "an answer to the one who was added")
    until(lambda: asked(viewer, "viewer"), "an answer to the one who was there")
    authority.revoke(own, "viewer")
    until(lambda: not asked(viewer, "viewer"), "silence")
    until(lambda: asked(bob, "bob"), "an answer after that")
    assert asked(viewer, "viewer") == []


def test_a_follower_loses_no_commit_while_the_register_changes(own, joined):
    kb_node, viewer = joined("kb_node"), joined("viewer")
    commits = bus.publisher(kb_node, keys.COMMIT)
    seen: list[int] = []
    bus.follow(viewer, keys.EFFECTS, lambda _, commit: seen.append(commit.seq))
    seq = 0

    def one_more():
        nonlocal seq
        seq += 1
        commits.put(codec.encode(Effects(seq=seq, id=str(seq))))
        return bool(seen)

    until(one_more, "the first commit")
    began = seen[0]
    for n in range(3):
        authority.add(own, f"guest{n}", "viewer")  # and the router restarts between any two of these
        guest, heard = joined(f"guest{n}"), []
        bus.follow(guest, keys.EFFECTS, lambda _, commit, heard=heard: heard.append(commit.seq))
        until(lambda heard=heard: one_more() and heard, "a commit for the guest")
    until(lambda: seen and seen[-1] == seq, "the last commit")
    assert seen == list(range(began, seq + 1))


def test_it_publishes_heartbeats(joined):
    beats: list[Health] = []
    bus.follow(joined("viewer"), keys.HEALTH, lambda _, health: beats.append(health))
    until(lambda: any(b.node == keys.ROUTER and b.state == "ready" for b in beats), "a beat")


def test_a_certificate_that_expires_soon_is_reported():
    now = datetime(2026, 11, 22, tzinfo=UTC)

    def said(*days):
        members = {
            f"m{d}": Member(name=f"m{d}", role="viewer", serial="1", expires=now + timedelta(days=d))
            for d in days
        }
        return describe_certificates(Register(hosts=(), members=members), now)

    assert said(365, 31) == "2 certificates"
    assert said(365, 29, 10) == "3 certificates; that of m10 expires on 2026-12-02"
    assert said(365, -1) == "2 certificates, 1 of them expired"
