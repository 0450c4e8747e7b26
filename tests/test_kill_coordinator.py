"""A coordinator that is killed again and again while a client adds without giving names."""

from __future__ import annotations

import os
import random
import signal
import threading
import time

import pytest

from schemas import errors
from tests.conftest import running, until


class Adder(threading.Thread):
    """Adds cups at full speed; two cups for one call would be one command done twice."""

    def __init__(self, system):
        super().__init__()
        self.added: list[str] = []
        self.unanswered = 0
        self.stopping = threading.Event()
        self._system = system

    def run(self):
        with self._system.client() as client:
            while not self.stopping.is_set():
                try:
                    (name,) = client.add("Cup", at=(1.0, 2.0, 0.0)).names
                    self.added.append(name)
                except errors.NoAnswer:
                    self.unanswered += 1


@pytest.mark.parametrize("kills", [3, pytest.param(30, marks=pytest.mark.long)])
def test_what_is_asked_once_is_done_once_however_often_the_coordinator_is_killed(tmp_path, kills):
    chance = random.Random(kills)
    with running(tmp_path, "--abox", "none", "--no-sim", "--no-record") as system, system.client() as client:
        adder = Adder(system)
        adder.start()
        pid = 0
        for _ in range(kills):
            count = len(adder.added)
            until(lambda seen=count: len(adder.added) > seen, "adding goes on")
            time.sleep(chance.uniform(0.0, 0.3))
            pid = until(lambda last=pid: (now := system.pid("coordinator")) != last and now, "it is back")
            os.kill(pid, signal.SIGKILL)
        count = len(adder.added)
        until(lambda: len(adder.added) > count, "adding goes on")
        adder.stopping.set()
        adder.join(60)
        assert not adder.is_alive()
        there = [entity.name for entity in client.list()]
    assert len(adder.added) == len(set(adder.added))
    assert set(adder.added) <= set(there)
    assert len(there) <= len(adder.added) + adder.unanswered
