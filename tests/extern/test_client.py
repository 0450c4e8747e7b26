"""The client before a system that keeps it waiting."""

import threading
import time

import pytest

from nodes import bus
from nodes.extern import client as client_module
from nodes.extern.client import connect
from nodes.supervisor import presence
from schemas import codec, errors, keys, replies
from schemas.commits import Commit
from tests.conftest import free_endpoint


def test_a_coordinator_that_is_too_busy_to_say_how_things_stand_is_told():
    endpoint, kept = free_endpoint(), []
    network = bus.Network(mode="peer", connect=(), listen=(endpoint,))
    with bus.open_session(network) as session, connect(endpoint) as client:
        queryable = session.declare_queryable(f"{keys.CMD}/*", kept.append)
        with pytest.raises(errors.NoAnswer, match=r"status did not answer within 0\.3 s"):
            client.status(timeout_s=0.3)
        queryable.undeclare()
    assert len(kept) == 1


def test_a_commit_that_does_not_come_is_waited_for_so_long():
    endpoint = free_endpoint()
    status = replies.SystemStatus(commit=3, entities=0, bodies=0, truth="map", in_agreement=True, nodes=())
    network = bus.Network(mode="peer", connect=(), listen=(endpoint,))
    with bus.open_session(network) as session, connect(endpoint) as client:
        bus.serve(session, keys.CMD, lambda request: request.reply(status))
        publisher = bus.publisher(session, keys.COMMIT)
        with client.commits(timeout=0.5) as commits:
            for seq in (3, 4):
                publisher.put(codec.encode(Commit(seq=seq, stamp_ns=1, id=str(seq), source="operator")))
            assert next(commits).seq == 4
            with pytest.raises(errors.NoAnswer, match=r"no commit came within 0\.5 s"):
                next(commits)


def test_a_refused_connection_is_told_at_once():
    start_s = time.monotonic()
    with pytest.raises(errors.NoAnswer, match="start one with: semmap up"), connect(free_endpoint()):
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
            with connect(endpoint):
                assert listening.is_set()
        finally:
            done.set()
            coordinator.join()


def test_a_system_that_does_not_come_is_said_to_be_starting(monkeypatch):
    monkeypatch.setattr(client_module, "_START_S", 0.2)
    endpoint = free_endpoint()
    with (
        presence.announced(endpoint),
        pytest.raises(errors.NoAnswer, match=f"the system at {endpoint} has not started yet"),
        connect(endpoint),
    ):
        pass
