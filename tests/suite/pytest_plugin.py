"""A plugin of pytest that records which tests failed, and can deal or shuffle the tests."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Callable, Iterable
from itertools import groupby
from pathlib import Path
from typing import TypeVar

import pytest

from tests.shared_systems import FIXTURES, fixtures_of
from tests.suite.failures import Failure, write_failures

_Any = TypeVar("_Any")
_BROWSER = "chromium"
_LOAD_OF_A_PAGE = 6
"""As many other files that need processes take as long as one that tests the page in a browser."""


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
        items[:] = deal(share_out(slow, workers, _shared_by, _load_of), fast)


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
    files: list[list[_Any]],
    workers: int,
    shared_by: Callable[[list[_Any]], Iterable[str]],
    load_of: Callable[[list[_Any]], int],
) -> list[list[_Any]]:
    """Return the tests of each worker: about the same load, files that use the same shared system together.

    `shared_by(tests)` returns the names of the shared systems that the tests of a file use, and
    `load_of(tests)` how long they take, in any unit.
    """
    by_systems: dict[tuple[str, ...], list[list[_Any]]] = {}
    for tests in files:
        by_systems.setdefault(tuple(sorted(shared_by(tests))), []).append(tests)
    alone = by_systems.pop((), [])
    loads: Counter[str] = Counter()
    for systems, several in by_systems.items():  # those that use two systems are given to the worker of one
        loads[systems[-1]] += sum(map(load_of, several))
    shares: list[list[_Any]] = [[] for _ in range(workers)]
    taken = [0] * workers
    worker_of: dict[str, int] = {}
    for system, load in loads.most_common():
        worker_of[system] = worker = taken.index(min(taken))
        taken[worker] += load
    for systems, several in sorted(by_systems.items()):
        shares[worker_of[systems[-1]]] += [test for tests in several for test in tests]
    for tests in alone:
        worker = taken.index(min(taken))
        shares[worker] += tests
        taken[worker] += load_of(tests)
    return shares


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
    return {name for test in tests for name in fixtures_of(test) if name in (*FIXTURES, _BROWSER)}


def _load_of(tests: list[pytest.Item]) -> int:
    """Return how long a file that needs processes takes, in about 4 s on two idle cores."""
    return _LOAD_OF_A_PAGE if _BROWSER in _shared_by(tests) else 1


def _message(report: pytest.TestReport | pytest.CollectReport) -> str:
    """The first line of what went wrong."""
    crash = getattr(report.longrepr, "reprcrash", None)
    text = str(getattr(crash, "message", None) or report.longrepr or "")
    return next((line for line in map(str.strip, text.splitlines()) if line), "")
