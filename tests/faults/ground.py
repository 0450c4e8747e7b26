"""The system under test: it runs under load, and every acknowledged change is counted."""

from __future__ import annotations

import contextlib
import random
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from semmap.nodes.extern.client import Client, connect
from semmap.nodes.supervisor.ports import free_endpoint
from semmap.schemas import errors
from semmap.schemas.replies import NodeStatus
from tests.conftest import System, running

PATIENCE_S = 60.0
BREATH_S = 0.05
"""Pause between two cups if a simulator creates a body of each, so that it is not saturated."""


def free_place() -> tuple[float, float, float]:
    """Return a position on the floor of a large hall, away from other objects."""
    return random.uniform(-200.0, 200.0), random.uniform(20.0, 200.0), 0.0


class Load(threading.Thread):
    """Adds cups one after another, alternately with and without a name, so that a repetition shows."""

    def __init__(self, endpoint: str, number: int, breath_s: float, *, insists: bool = False) -> None:
        """`number` identifies its cups; it pauses for `breath_s` after each.

        With `insists`, an unanswered change is sent again under its id until it is answered.
        """
        super().__init__(daemon=True)
        self._insists = insists
        self.in_doubt = False
        """Whether the last change is unanswered."""
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
    """A running system (`semmap up` with options) that can be restarted.

    It is under load from the start until `reckon`, and again after `load_again`.
    """

    def __init__(self, data: Path, words: tuple[str, ...]) -> None:
        self.data = data
        self.endpoint = free_endpoint()
        self._words = words
        self._stack = contextlib.ExitStack()
        self.system = self.start()
        self.observed_s = 0.0
        self.may_be_refused: str | None = None
        """A part of the message of expected rejections; rejected changes count as not made."""
        self._acknowledged: set[str] = set()
        self._there: set[str] = set()
        """The cups at the last count."""
        self._loads = 0
        self.load_again()

    def load_again(self) -> None:
        """Begin another load; a running one is counted first."""
        if self._loads and self.load.is_alive():
            self.reckon()
        self._loads += 1
        self.load = Load(self.endpoint, self._loads, 0.0 if "--no-sim" in self._words else BREATH_S)
        self.load.start()

    def start(self) -> System:
        """Start or restart it."""
        self.system = self._stack.enter_context(running(self.data, *self._words, endpoint=self.endpoint))
        return self.system

    def observe(self, seconds: float) -> None:
        """Wait, without counting the time as recovery time."""
        time.sleep(seconds)
        self.observed_s += seconds

    def client(self) -> contextlib.AbstractContextManager[Client]:
        return self.system.client()

    def nodes(self) -> dict[str, NodeStatus]:
        """Return the ready nodes, by name."""
        with self.client() as client:
            return {node.node: node for node in client.status().nodes if node.state == "ready"}

    def seconds_until_whole(self) -> float:
        """Return the time until every node is ready, and a new client can make a change."""
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

        wait_for(is_whole, "the system has recovered")
        seen = len(self.load.added)
        wait_for(lambda: len(self.load.added) > seen, "the load continues")
        return time.monotonic() - began_s

    def _settings(self) -> Any:
        from semmap.nodes.supervisor.control import Supervisor

        return Supervisor(self.data).settings

    def reckon(self) -> tuple[int, int]:
        """Stop the load; return the number of lost and of doubled changes."""
        self.load.stop()
        expected = self.may_be_refused
        refused = [text for text in self.load.refused if expected is None or expected not in text]
        assert not refused, refused[:3]
        with self.client() as client:
            there = {entity.name for entity in client.list("Cup")}
        added = set(self.load.added)
        self._acknowledged |= added
        repeated = len(self.load.added) - len(added)
        unexplained = len(there - self._there) - len(added) - self.load.unanswered
        self._there = there
        return len(self._acknowledged - there), repeated + max(0, unexplained)

    def close(self) -> None:
        with contextlib.suppress(AssertionError):
            self.load.stop()
        self._stack.close()


def wait_for(condition: Callable[[], Any], what: str, *, within_s: float = PATIENCE_S) -> Any:
    """Return the result of `condition()` as soon as it is true; fail after a time-out."""
    deadline_s = time.monotonic() + within_s
    while time.monotonic() < deadline_s:
        if result := condition():
            return result
        time.sleep(0.05)
    raise AssertionError(f"timed out after {within_s:g} s: {what}")
