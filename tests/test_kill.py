"""A knowledge base that is killed again and again while a client commits as fast as it can."""

from __future__ import annotations

import os
import random
import signal
import threading
import time

import pytest

from schemas import errors
from tests.conftest import running, until


class Committer(threading.Thread):
    """Adds chairs at full speed, and remembers what was acknowledged with which commit."""

    def __init__(self, system):
        super().__init__()
        self.acknowledged = {}
        self.unanswered = set()
        self.stopping = threading.Event()
        self._system = system

    def run(self):
        with self._system.client() as client:
            i = 0
            while not self.stopping.is_set():
                i += 1
                name = f"chair{i}"
                try:
                    reply = client.add("Chair", name, at=(i % 97, i % 89, 0.0), ref="chair", alt=("seat",))
                    self.acknowledged[name] = reply.commit
                except errors.NoAnswer:
                    self.unanswered.add(name)


@pytest.mark.parametrize("kills", [3, pytest.param(50, marks=pytest.mark.long)])
def test_every_acknowledged_commit_is_there_and_no_other_one_half(tmp_path, kills):
    chance = random.Random(kills)
    with running(tmp_path, "--abox", "none", "--no-sim", "--no-record") as system:
        committer = Committer(system)
        committer.start()
        pid = 0
        for _ in range(kills):
            count = len(committer.acknowledged)
            until(lambda seen=count: len(committer.acknowledged) > seen, "commits go on")
            time.sleep(chance.uniform(0.0, 0.3))
            pid = until(lambda last=pid: (now := system.pid("kb_node")) != last and now, "it is back")
            os.kill(pid, signal.SIGKILL)
        count = len(committer.acknowledged)
        until(lambda: len(committer.acknowledged) > count, "commits go on")
        committer.stopping.set()
        committer.join(60)
        assert not committer.is_alive()
        with system.client() as client:
            there = {e.name: e for e in client.list()}
            commits = client.history(limit=10_000)
            assert client.check().consistent
    assert committer.acknowledged.keys() <= there.keys()
    assert there.keys() - committer.acknowledged.keys() <= committer.unanswered
    for entity in there.values():
        assert entity.pose is not None
        assert (entity.preferred_reference, entity.alternative_references) == ("chair", ("seat",))
    for name, seq in committer.acknowledged.items():
        assert there[name].provenance.commit == seq
    seqs = [c.seq for c in commits]
    assert seqs == list(range(seqs[0], seqs[-1] + 1))
    assert seqs[-1] == len(there) + 1


def test_whoever_asks_right_after_a_kill_waits_for_the_restart(tmp_path):
    with running(tmp_path, "--abox", "none", "--no-sim", "--no-record") as system, system.client() as client:
        for i, ask in enumerate(
            (
                lambda: client.add("Chair", "chair1", at=(1.0, 2.0, 0.0)).commit,
                lambda: client.undo().commit,
                lambda: client.history()[-1].seq,
            )
        ):
            until(lambda: client.history(), "the knowledge base answers")
            os.kill(system.pid("kb_node"), signal.SIGKILL)
            assert ask() == min(i + 2, 3)
