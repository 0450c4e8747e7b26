"""Shared systems are started when they are needed, and stopped when the next tests do not use them."""

from __future__ import annotations

import contextlib

import pytest

from tests import shared_systems
from tests.shared_systems import IDLE_TESTS, SharedSystem, is_one_running, stop_unused


class Fake:
    """A system that notes what is done with it."""

    def __init__(self, noted):
        self._noted = noted

    def begin_anew(self, abox):
        self._noted.append(f"begin {abox}")


@pytest.fixture
def noted():
    return []


@pytest.fixture
def shared(monkeypatch, noted):
    monkeypatch.setattr(shared_systems, "_running", {})

    @contextlib.contextmanager
    def start(abox):
        noted.append(f"start {abox}")
        yield Fake(noted)
        noted.append("stop")

    return SharedSystem("_shared_map", start)


@pytest.fixture
def items(monkeypatch):
    """Make tests of the names of their fixtures."""
    monkeypatch.setattr(shared_systems, "fixtures_of", lambda fixtures: fixtures)
    unused, used = ("tmp_path",), ("empty_map", "_shared_map")
    return lambda number: [*([unused] * number), used]


def test_a_system_is_started_once_for_several_modules(shared, noted):
    assert shared.begin_anew("flat") is shared.begin_anew("none")
    assert noted == ["start flat", "begin none"]


def test_a_system_is_stopped_when_the_next_tests_do_not_use_it(shared, noted, items):
    shared.begin_anew("flat")
    stop_unused(items(IDLE_TESTS - 1))
    assert is_one_running()
    stop_unused(items(IDLE_TESTS))
    assert not is_one_running()
    assert noted == ["start flat", "stop"]


def test_a_stopped_system_is_started_again(shared, noted):
    shared.begin_anew("flat")
    shared.stop()
    shared.stop()
    shared.begin_anew("none")
    assert noted == ["start flat", "stop", "start none"]
