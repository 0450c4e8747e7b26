"""Kills a node repeatedly while a client sends requests as fast as possible."""

from __future__ import annotations

import os
import random
import signal
import threading
import time

from semmap.schemas import errors
from tests.conftest import until


class Busy(threading.Thread):
    """A client that runs `step` repeatedly until it is stopped."""

    def __init__(self, system):
        super().__init__()
        self.done = 0
        self._system = system
        self._stopping = threading.Event()

    def run(self):
        with self._system.client() as client:
            while not self._stopping.is_set():
                try:
                    self.step(client)
                    self.done += 1
                except errors.NoAnswer:
                    self.unanswered()

    def step(self, client):
        """Send one command and wait for its reply; may raise NoAnswer."""
        raise NotImplementedError

    def unanswered(self):
        """Handle a step without a reply, which may have been executed."""
        raise NotImplementedError

    def stop(self):
        self._stopping.set()
        self.join(60)
        assert not self.is_alive()

    def goes_on(self):
        """Wait for one more completed step."""
        before = self.done
        until(lambda: self.done > before, "the client goes on")


def kill_again_and_again(system, node, busy, kills):
    """Kill a node repeatedly while `busy` works, each time after it is back; then stop the client."""
    chance = random.Random(kills)
    busy.start()
    pid = 0
    for _ in range(kills):
        busy.goes_on()
        time.sleep(chance.uniform(0.0, 0.3))
        pid = until(lambda last=pid: (now := system.pid(node)) != last and now, "it is back")
        os.kill(pid, signal.SIGKILL)
    busy.goes_on()
    busy.stop()
