"""Systems that the modules of a pytest worker use one after the other.

They run only while they are needed: an idle system takes a twentieth of a processor.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from tests.conftest import System

FIXTURES = frozenset({"_shared_map", "_shared_scene", "_shared_robot", "_shared_full"})
"""The fixtures that return a shared system."""
IDLE_TESTS = 500
"""A system is stopped if none of so many following tests uses it."""
_running: dict[str, SharedSystem] = {}
"""The shared systems that run, by their fixtures."""


class SharedSystem:
    """A system that is started when a module needs it, and continues for the next module."""

    def __init__(
        self, fixture: str, start: Callable[[str], contextlib.AbstractContextManager[System]]
    ) -> None:
        """Create it for a fixture; `start(abox)` starts a system with the shipped flat or with 'none'."""
        self._fixture = fixture
        self._start = start
        self._end = contextlib.ExitStack()
        self._system: System | None = None

    def begin_anew(self, abox: str) -> System:
        """Return the system with the map that a first `semmap up --abox ABOX` creates."""
        if self._system is not None:
            self._system.begin_anew(abox)
        return self.use(abox)

    def use(self, abox: str) -> System:
        """Return the system with the map as it is; if it does not run, start it with that map."""
        if self._system is None:
            self._system = self._end.enter_context(self._start(abox))
            _running[self._fixture] = self
        return self._system

    def stop(self) -> None:
        """Stop the system if it runs."""
        _running.pop(self._fixture, None)
        self._system = None
        self._end.close()


def stop_unused(following: Sequence[pytest.Item]) -> None:
    """Stop the shared systems that the next tests do not use; `following` are the tests in their order."""
    for fixture, shared in [*_running.items()]:
        if not any(fixture in fixtures_of(item) for item in following[:IDLE_TESTS]):
            shared.stop()


def is_one_running() -> bool:
    """Return whether a shared system runs."""
    return bool(_running)


def fixtures_of(item: pytest.Item) -> Sequence[str]:
    """Return the names of the fixtures that a test uses, directly or by other fixtures."""
    return item.fixturenames if isinstance(item, pytest.Function) else ()
