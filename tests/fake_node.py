"""A node without Zenoh: it records what is served, followed and asked."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import Future
from functools import partial
from typing import Any
from unittest.mock import MagicMock

from semmap.nodes.runtime.futures import settle
from semmap.schemas import errors, keys


class FakeNode:
    """`bridge(call)` answers requests to the knowledge base, `sim(call)` those to the simulator."""

    def __init__(self, bridge: Callable[[Any], Any], sim: Callable[[Any], Any] | None = None) -> None:
        self._answers = {keys.BRIDGE: bridge, keys.SIM: sim or _no_answer}
        self.session = MagicMock()
        self.followed: dict[str, list[Callable[[Any], None]]] = {}
        self.served: dict[str, Any] = {}
        self.repeated: list[Callable[[], None]] = []
        self.periods_s: dict[int, float] = {}
        self.idle: list[Callable[[], None]] = []
        self.reports: list[str] = []
        self.details: list[str] = []
        self.asked: list[Any] = []
        self.nodes = {"kb_node"}
        self.has_room: Callable[[], bool] = lambda: True

    def serve(self, prefix: str, handlers: dict[str, Any], **options: Any) -> None:
        self.served[prefix] = handlers
        self.options = options

    def follow(self, topic: keys.Topic, handle: Callable[[Any], None]) -> None:
        self.followed.setdefault(topic.key, []).append(handle)

    follow_newest = follow

    def every(self, period_s: float, handle: Callable[[], None]) -> Callable[[float], None]:
        """Note repeated work; `periods_s` has its present period."""
        number = len(self.repeated)
        self.repeated.append(handle)
        self.periods_s[number] = period_s
        return partial(self.periods_s.__setitem__, number)

    def when_idle(self, handle: Callable[[], None]) -> None:
        self.idle.append(handle)

    def while_there_is_room(self, has_room: Callable[[], bool]) -> None:
        self.has_room = has_room

    def ask(self, prefix: str, call: Any, **options: Any) -> Any:
        self.asked.append(call)
        return self._answers[prefix](call)

    def ask_later(self, prefix: str, call: Any, **options: Any) -> Future[Any]:
        future: Future[Any] = Future()
        settle(future, lambda: self.ask(prefix, call))
        return future

    def is_there(self, node: str) -> bool:
        return node in self.nodes

    def has_gone(self) -> Callable[[], bool]:
        return lambda: False

    def monitor_departures(self) -> None:
        pass

    def soon(self, handle: Callable[[], None]) -> None:
        handle()

    def ready(self, detail: str) -> None:
        self.details.append(f"ready: {detail}")

    def describe(self, detail: str | Callable[[], str]) -> None:
        self.details.append(detail if isinstance(detail, str) else detail())

    def note(self, notes: tuple[str, ...]) -> None:
        self.notes = notes

    def report(self, text: str) -> None:
        self.reports.append(text)

    def publish(self, topic: keys.Topic, message: Any) -> None:
        """Call all that follow a topic."""
        for handle in self.followed[topic.key]:
            handle(message)

    def do(self, command: Any, prefix: str = keys.CMD) -> Any:
        """Handle a command, with the changes that it schedules."""
        _, handle = self.served[prefix][command.VERB]
        made = handle(command)
        for step in self.idle:
            step()
        return made

    def tick(self) -> None:
        """Do all repeated work once; a node that is at long work calls this for its heartbeat."""
        for handle in self.repeated:
            handle()


def _no_answer(call: Any) -> Any:
    raise errors.NoAnswer("no response from the simulator")


class FakeStream:
    """Stands for `bus.NewestSamples`: yields what a test has put into it."""

    def __init__(self, *_: Any, **__: Any) -> None:
        self.samples: list[tuple[str, Any]] = []

    def take(self) -> Iterator[tuple[str, Callable[[], Any]]]:
        """Yield each key with a function that returns its message, or raises it."""
        samples, self.samples = self.samples, []
        for key, message in samples:
            yield key, partial(_read, message)


def _read(message: Any) -> Any:
    if isinstance(message, Exception):
        raise message
    return message
