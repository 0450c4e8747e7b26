"""What a fault is done to: a system under load, whose every acknowledged change is accounted for."""

from __future__ import annotations

import contextlib
import random
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from semmap.nodes.extern.client import Client, connect
from semmap.nodes.extern.testing import free_endpoint
from semmap.schemas import errors
from semmap.schemas.replies import NodeStatus
from tests.conftest import System, running

PATIENCE_S = 60.0
BREATH_S = 0.05
"""Between two cups where a simulator makes a body of each: hundreds a second would keep it from all else."""


def free_place() -> tuple[float, float, float]:
    """On the floor of a wide hall, away from the rest: what overlaps is another matter."""
    return random.uniform(-200.0, 200.0), random.uniform(20.0, 200.0), 0.0


class Load(threading.Thread):
    """Adds cups one after another: by turns with a name, and without one so that a repetition would show."""

    def __init__(self, endpoint: str, number: int, breath_s: float, *, insists: bool = False) -> None:
        """`number` tells its cups from those of other loads; it rests for `breath_s` after each.

        One that `insists` sends a change that was not answered again, under its id, until it is.
        """
        super().__init__(daemon=True)
        self._insists = insists
        self.in_doubt = False
        """Has the last change that it asked for not been answered?"""
        self._breath_s = breath_s
        self._number = number
        self.added: list[str] = []
        self.unanswered = 0
        self.refused: list[str] = []
        self._endpoint = endpoint
        self._stopping = threading.Event()

    def run(self) -> None:
        asked = 0
        while not self._stopping.is_set():
            try:
                with connect(self._endpoint, agent="load") as client:
                    while not self._stopping.is_set():
                        if not (self._insists and self.in_doubt):
                            asked += 1
                            name = f"cup_of_load_{self._number}_{asked}" if asked % 2 else None
                            at, change = free_place(), f"load {self._number} {asked} {random.random()}"
                        self.in_doubt = True
                        self.added += client.add("Cup", name, at=at, id=change).names
                        self.in_doubt = False
                        self._stopping.wait(self._breath_s)
            except errors.NoAnswer:
                self.unanswered += 1
                time.sleep(0.1)
            except errors.SemmapError as error:
                self.refused.append(error.text)

    def stop(self) -> None:
        self._stopping.set()
        self.join(PATIENCE_S)
        assert not self.is_alive(), "a change is still not answered"


class Ground:
    """A running system, by `semmap up` with some words, that can be started again.

    It is under load from the start until it is reckoned up, and once more after `load_again`.
    """

    def __init__(self, data: Path, words: tuple[str, ...]) -> None:
        self.data = data
        self.endpoint = free_endpoint()
        self._words = words
        self._stack = contextlib.ExitStack()
        self.system = self.start()
        self.observed_s = 0.0
        self.may_be_refused: str | None = None
        """What is said, among other things, where a fault has changes refused; they count as not made."""
        self._acknowledged: set[str] = set()
        self._there: set[str] = set()
        """The cups as they were reckoned up last."""
        self._loads = 0
        self.load_again()

    def load_again(self) -> None:
        """Begin another load; one that a fault left going on is reckoned up."""
        if self._loads and self.load.is_alive():
            self.reckon()
        self._loads += 1
        self.load = Load(self.endpoint, self._loads, 0.0 if "--no-sim" in self._words else BREATH_S)
        self.load.start()

    def start(self) -> System:
        """Start it (again)."""
        self.system = self._stack.enter_context(running(self.data, *self._words, endpoint=self.endpoint))
        return self.system

    def observe(self, seconds: float) -> None:
        """See what happens for a while, which does not count as time that the system takes."""
        time.sleep(seconds)
        self.observed_s += seconds

    def client(self) -> contextlib.AbstractContextManager[Client]:
        return self.system.client()

    def nodes(self) -> dict[str, NodeStatus]:
        """The nodes that are heard of, by name."""
        with self.client() as client:
            return {node.node: node for node in client.status().nodes if node.state == "ready"}

    def seconds_until_whole(self) -> float:
        """How long it takes until every node is ready, and a change is made by somebody who comes anew."""
        began_s = time.monotonic()
        wanted = set(self._settings().nodes)

        def is_whole() -> bool:
            try:
                with self.client() as client:
                    status = client.status()
                    ready = {node.node for node in status.nodes if node.state == "ready"}
                    return ready >= wanted and bool(client.add("Plate", at=free_place()).names)
            except errors.NoAnswer:
                return False

        wait_for(is_whole, "the system is whole again")
        seen = len(self.load.added)
        wait_for(lambda: len(self.load.added) > seen, "the load goes on")
        return time.monotonic() - began_s

    def _settings(self) -> Any:
        from semmap.nodes.supervisor.control import Supervisor

        return Supervisor(self.data).settings

    def reckon(self) -> tuple[int, int]:
        """Stop the load; how many acknowledged changes are lost, how many of this load were done twice."""
        self.load.stop()
        expected = self.may_be_refused
        refused = [text for text in self.load.refused if expected is None or expected not in text]
        assert not refused, refused[:3]
        with self.client() as client:
            there = {entity.name for entity in client.list("Cup")}
        added = set(self.load.added)
        self._acknowledged |= added
        said_twice = len(self.load.added) - len(added)
        nobodys = len(there - self._there) - len(added) - self.load.unanswered
        self._there = there
        return len(self._acknowledged - there), said_twice + max(0, nobodys)

    def close(self) -> None:
        with contextlib.suppress(AssertionError):
            self.load.stop()
        self._stack.close()


def wait_for(condition: Callable[[], Any], what: str, *, within_s: float = PATIENCE_S) -> Any:
    """What `condition()` gives as soon as it holds; an AssertionError after a while."""
    deadline_s = time.monotonic() + within_s
    while time.monotonic() < deadline_s:
        if result := condition():
            return result
        time.sleep(0.05)
    raise AssertionError(f"waited {within_s:g} s in vain: {what}")
