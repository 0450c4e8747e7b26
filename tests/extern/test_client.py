"""The client with a system that replies late or not at all."""

import contextlib
import time

import pytest

from semmap.nodes import bus
from semmap.nodes.extern.client import Client, connect
from semmap.schemas import codec, commands, errors, keys, replies
from semmap.schemas.commands import Status
from semmap.schemas.commits import Commit
from tests.conftest import free_endpoint


def test_a_coordinator_that_is_too_busy_for_its_status_is_reported():
    endpoint, kept = free_endpoint(), []
    network = bus.Network(mode="peer", connect=(), listen=(endpoint,))
    with bus.open_session(network) as session, connect(endpoint) as client:
        queryable = session.declare_queryable(f"{keys.CMD}/*", kept.append)
        with pytest.raises(errors.NoAnswer, match=r"status did not answer within 0\.3 s"):
            client.send(Status(), timeout_s=0.3)
        queryable.undeclare()
    assert len(kept) == 1


@contextlib.contextmanager
def system_at(commit):
    """A client of a system that is at this commit, and a function that publishes one more."""
    endpoint = free_endpoint()
    status = replies.SystemStatus(
        commit=commit, entities=0, bodies=0, truth="map", in_agreement=True, nodes=()
    )
    network = bus.Network(mode="peer", connect=(), listen=(endpoint,))
    with bus.open_session(network) as session, connect(endpoint) as client:
        bus.serve(session, keys.CMD, lambda request: request.reply(status))
        publisher = bus.publisher(session, keys.COMMIT)

        def publish(seq, stamp_ns=1):
            publisher.put(codec.encode(Commit(seq=seq, stamp_ns=stamp_ns, id=str(seq), source="operator")))

        yield client, publish


def test_a_commit_that_does_not_come_is_waited_for_so_long():
    with system_at(3) as (client, publish), client.commits(timeout=0.5) as commits:
        publish(3)
        publish(4)
        assert next(commits).seq == 4
        with pytest.raises(errors.NoAnswer, match=r"no commit received within 0\.5 s"):
            next(commits)


def test_commits_of_another_map_at_the_same_endpoint_are_received():
    with system_at(168) as (client, publish), client.commits(timeout=5.0) as commits:
        publish(167)
        publish(2, stamp_ns=time.time_ns())
        assert next(commits).seq == 2


def test_the_restart_of_a_node_is_waited_for_where_work_may_be_under_way(monkeypatch):
    """So a load whose coordinator is killed ends with what became of it."""
    seen = {}
    monkeypatch.setattr(
        bus, "ask", lambda session, prefix, verb, *_, patience_s, **how: seen.update({verb: patience_s})
    )
    monkeypatch.setattr(bus, "LivelinessMonitor", lambda session: None)
    client = Client(None, source="operator")
    for command in (commands.Load(content=b"x"), commands.Undo(), commands.Clear(), commands.Get(name="a")):
        client.send(command)
    assert seen == dict.fromkeys(("load", "undo", "clear"), bus.RESTART_S) | {"get": bus.PATIENCE_S}
