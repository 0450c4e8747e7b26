"""Kills the knowledge base repeatedly while a client commits as fast as possible."""

from __future__ import annotations

import os
import signal
import threading

import pytest

from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from tests.conftest import until
from tests.killing import Busy, kill_again_and_again


class Committer(Busy):
    """Adds chairs, and remembers what was acknowledged with which commit."""

    def __init__(self, system):
        super().__init__(system)
        self.acknowledged = {}
        self.lost = set()
        self._number = 0

    def step(self, client):
        self._number += 1
        i = self._number
        reply = client.add("Chair", f"chair{i}", at=(i % 97, i % 89, 0.0), ref="chair", alt=("seat",))
        self.acknowledged[f"chair{i}"] = reply.commit

    def unanswered(self):
        self.lost.add(f"chair{self._number}")


@pytest.mark.parametrize("kills", [3, pytest.param(50, marks=pytest.mark.long)])
def test_every_acknowledged_commit_is_there_and_no_other_one_half(empty_map, kills):
    empty_map.begin_anew("none")
    committer = Committer(empty_map)
    kill_again_and_again(empty_map, "kb_node", committer, kills)
    with empty_map.client() as client:
        there = {e.name: e for e in client.list()}
        commits = client.history(limit=10_000)
        assert client.check().consistent
    assert committer.acknowledged.keys() <= there.keys()
    assert there.keys() - committer.acknowledged.keys() <= committer.lost
    for entity in there.values():
        assert entity.pose is not None
        assert (entity.preferred_reference, entity.alternative_references) == ("chair", ("seat",))
    for name, seq in committer.acknowledged.items():
        assert there[name].provenance.commit == seq
    seqs = [c.seq for c in commits]
    assert seqs == list(range(seqs[0], seqs[-1] + 1))
    assert seqs[-1] == len(there) + 1


def test_a_request_right_after_a_kill_waits_for_the_restart(empty_map):
    empty_map.begin_anew("none")
    with empty_map.client() as client:
        for i, ask in enumerate(
            (
                lambda: client.add("Chair", "chair1", at=(1.0, 2.0, 0.0)).commit,
                lambda: client.undo().commit,
                lambda: client.history()[-1].seq,
            )
        ):
            until(lambda: client.history(), "the knowledge base answers")
            os.kill(empty_map.pid("kb_node"), signal.SIGKILL)
            assert ask() == min(i + 2, 3)


def write_file(path):
    """Write a file on whose load the knowledge base works long enough to be killed meanwhile."""
    path.write_text("".join(f"<{v.ABOX}c{i}> a <{v.TBOX}Chair> .\n" for i in range(20_000)))
    return path


def stop_at_work(system, pid, is_loading):
    """Stop the knowledge base while it works on a request, or return at the end of the load."""
    in_work = system.data / "in_work" / "kb_node"

    def is_stopped():
        if in_work.read_bytes()[:1] == b"\0":
            return not is_loading()
        os.kill(pid, signal.SIGSTOP)
        if in_work.read_bytes()[:1] != b"\0":
            return True
        os.kill(pid, signal.SIGCONT)  # it was about to end the request
        return False

    until(is_stopped, "the knowledge base works on a request")


def test_a_request_that_ended_the_node_twice_is_rejected(empty_map, tmp_path):
    empty_map.begin_anew("none")
    file, ended = write_file(tmp_path / "many.ttl"), []

    def load(client):
        try:
            ended.append(client.load(file, dry_run=True))
        except errors.SemmapError as error:
            ended.append(error)

    with empty_map.client() as client:
        loading = threading.Thread(target=load, args=(client,))
        loading.start()
        pid = 0
        while loading.is_alive():  # a load is several requests: one of them is met twice
            pid = until(lambda last=pid: (now := empty_map.pid("kb_node")) != last and now, "it is back")
            stop_at_work(empty_map, pid, loading.is_alive)
            os.kill(pid, signal.SIGKILL)
        (rejected,) = ended
        assert isinstance(rejected, errors.Refused)
        assert rejected.text == (
            "kb_node: request rejected: it ended the node twice; restart the system to try it again"
        )
        assert client.add("Chair", "chair1", at=(1.0, 2.0, 0.0)).commit == 2


def test_a_request_whose_client_has_gone_is_not_sent_again(empty_map, tmp_path):
    empty_map.begin_anew("none")
    file = write_file(tmp_path / "many.ttl")
    with empty_map.client() as client:
        pid = empty_map.pid("kb_node")
        with empty_map.spawned("load", str(file)) as loading:
            stop_at_work(empty_map, pid, lambda: loading.poll() is None)
            loading.kill()
            loading.wait()
            os.kill(pid, signal.SIGKILL)
        assert client.add("Chair", "chair1", at=(1.0, 2.0, 0.0)).commit == 2
        assert [entity.name for entity in client.list()] == ["chair1"]
