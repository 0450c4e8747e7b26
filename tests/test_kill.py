"""Kills the knowledge base repeatedly while a client commits as fast as possible."""

from __future__ import annotations

import os
import signal

import pytest

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
