"""The runs of pytest that make up the suite."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import IO

from tests.suite.failures import Failure, read_failures

PARTS: tuple[tuple[str, ...], ...] = (
    ("-n", "3", "--dist", "worksteal", "--ignore", "tests/page"),  # on two cores: many wait for a system
    ("tests/page",),  # alone: Chromium draws with both cores
)
"""Words for pytest: the page's tests run after all others."""
NONE_COLLECTED = 5
"""Pytest's exit status where there was no such test."""
_ENDS_A_HANGING_TEST = ("-o", "faulthandler_timeout=600", "-o", "faulthandler_exit_on_timeout=true")


def run_pytest(*words: str, failures: Path, output: IO[bytes] | None = None) -> int:
    """Run pytest and return its exit status; it writes its `failures` to a file.

    A test that hangs is ended, with a trace of each of its threads. The output goes where ours goes, or
    to a file.
    """
    plugin = ("-p", "tests.suite.pytest_plugin", "--failures", str(failures))
    command = [sys.executable, "-m", "pytest", *plugin, *_ENDS_A_HANGING_TEST, *words]
    process = subprocess.Popen(command, stdout=output, stderr=subprocess.STDOUT if output else None)
    try:
        return process.wait()
    except KeyboardInterrupt:  # which pytest has heard, too: it ends what its tests have started
        process.wait()
        raise


def find_failures(status: int, path: Path) -> list[Failure] | None:
    """Return what failed in a run that ended with `status`; None if it broke off."""
    found = read_failures(path)
    return None if found is None or (status not in (0, NONE_COLLECTED) and not found) else found
