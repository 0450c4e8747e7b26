"""A plugin of pytest that records which tests failed, and can deal or shuffle the tests."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterable
from itertools import groupby
from pathlib import Path
from typing import TypeVar

import pytest

from tests.shared_systems import FIXTURES, fixtures_of
from tests.suite.failures import Failure, write_failures

_Any = TypeVar("_Any")


class _Recorder:
    """Keeps the first failure of each test, and writes all of them at the end."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._failures: dict[str, Failure] = {}

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.failed:
            self._note(report, needs_process="process" in report.keywords)

    def pytest_collectreport(self, report: pytest.CollectReport) -> None:
        if report.failed:
            self._note(report, needs_process=False)

    def pytest_sessionfinish(self) -> None:
        write_failures(self._path, [*self._failures.values()])

    def _note(self, report: pytest.TestReport | pytest.CollectReport, needs_process: bool) -> None:
        failure = Failure(report.nodeid, needs_process, _message(report))
        self._failures.setdefault(report.nodeid, failure)


class _Shuffler:
    """Puts the files in an order drawn by a seed, and the tests of each file."""

    def __init__(self, seed: int) -> None:
        self._seed = seed

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        items[:] = shuffle(items, self._seed)


class _Dealer:
    """Gives each worker of pytest-xdist as many of the slow files, before all others.

    Files that use the same shared system are given to the same worker, so that only that one starts it.
    """

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(self, config: pytest.Config, items: list[pytest.Item]) -> None:
        workers = config.workerinput["workercount"] if hasattr(config, "workerinput") else 1
        files = [[*several] for _, several in groupby(items, lambda item: item.path)]
        slow = [several for several in files if any(item.get_closest_marker("process") for item in several)]
        fast = [several for several in files if several not in slow]
        items[:] = deal(share_out(slow, workers, _shared_by), fast)


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--failures", type=Path, help="write the failures to this file")
    parser.addoption("--deal", action="store_true", help="run the tests that need processes first")
    parser.addoption("--shuffle", type=int, metavar="SEED", help="run in an order drawn by this seed")


def pytest_configure(config: pytest.Config) -> None:
    if (path := config.getoption("--failures")) and not hasattr(config, "workerinput"):
        config.pluginmanager.register(_Recorder(path))
    if config.getoption("--deal"):
        config.pluginmanager.register(_Dealer())
    if (seed := config.getoption("--shuffle")) is not None:
        config.pluginmanager.register(_Shuffler(seed))


def shuffle(items: list[pytest.Item], seed: int) -> list[pytest.Item]:
    """Return the tests in an order drawn by `seed`; those of a file stay together, with what they share."""
    dice = random.Random(seed)
    files = [[*several] for _, several in groupby(items, lambda item: item.path)]
    dice.shuffle(files)
    for several in files:
        dice.shuffle(several)
    return [item for several in files for item in several]


def share_out(
    files: list[list[_Any]], workers: int, shared_by: Callable[[list[_Any]], Iterable[str]]
) -> list[list[_Any]]:
    """Return the tests of each worker: equally many files, those that use the same shared system together.

    `shared_by(tests)` returns the names of the shared systems that the tests of a file use.
    """
    used = [tuple(sorted(shared_by(tests))) for tests in files]
    systems = sorted({system for several in used for system in several})
    shares: list[list[list[_Any]]] = [[] for _ in range(workers)]
    for several in sorted({*used} - {()}):
        share = shares[systems.index(several[-1]) % workers]
        share += [tests for tests, needed in zip(files, used, strict=True) if needed == several]
    for tests, needed in zip(files, used, strict=True):
        if not needed:
            min(shares, key=len).append(tests)
    return [[test for tests in share for test in tests] for share in shares]


def deal(shares: list[list[_Any]], fast: list[list[_Any]]) -> list[_Any]:
    """Return these shares of slow tests, and fast files, in an order that keeps all workers busy to the end.

    pytest-xdist gives each worker one stretch of the order, all of the same length, and those who have
    finished take from the end of another's. So each stretch begins with the worker's share of the slow tests,
    and the tests that are moved between workers are fast ones.
    """
    rest = [test for file in fast for test in file]
    left = len(rest) + sum(map(len, shares))
    order: list[_Any] = []
    for number, share in enumerate(shares):
        length = left // (len(shares) - number)  # as pytest-xdist divides them
        left -= length
        missing = max(0, length - len(share))
        order += share + rest[:missing]
        del rest[:missing]
    return order + rest


def _shared_by(tests: list[pytest.Item]) -> set[str]:
    """Return the names of the shared systems that the tests of a file use."""
    return {name for test in tests for name in fixtures_of(test) if name in FIXTURES}


def _message(report: pytest.TestReport | pytest.CollectReport) -> str:
    """The first line of what went wrong."""
    crash = getattr(report.longrepr, "reprcrash", None)
    text = str(getattr(crash, "message", None) or report.longrepr or "")
    return next((line for line in map(str.strip, text.splitlines()) if line), "")
