"""A run of pytest, and what failed in it."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import IO

from tests.suite.failures import Failure, read_failures

IN_PARALLEL: tuple[str, ...] = ("-n", "4", "--dist", "worksteal", "--deal")
"""Arguments for pytest. Four workers keep two cores busy, because many tests wait for a system."""
_MEMORY = Path("/dev/shm")
_ENOUGH_BYTES = 1 << 30
"""The suite's temporary files take about 100 MB."""
NONE_COLLECTED = 5
"""Pytest's exit status where there was no such test."""
_ENDS_A_HANGING_TEST = ("-o", "faulthandler_timeout=600", "-o", "faulthandler_exit_on_timeout=true")


def run_pytest(*words: str, failures: Path, output: IO[bytes] | None = None) -> int:
    """Run pytest and return its exit status; it writes its `failures` to a file.

    A test that hangs is ended, with a trace of each of its threads. The output goes where ours goes, or
    to a file.
    """
    environment = {**os.environ, **keep_files_in_memory()}
    plugin = ("-p", "tests.suite.pytest_plugin", "--failures", str(failures))
    command = [sys.executable, "-m", "pytest", *plugin, *_ENDS_A_HANGING_TEST, *words]
    process = subprocess.Popen(
        command, stdout=output, stderr=subprocess.STDOUT if output else None, env=environment
    )
    try:
        return process.wait()
    except KeyboardInterrupt:  # which pytest has heard, too: it ends what its tests have started
        process.wait()
        raise


def keep_files_in_memory() -> dict[str, str]:
    """Return the environment in which temporary files are in memory, if there is room; nothing otherwise.

    Thousands of journals are opened and synced, which takes a third of the time on a disk.
    """
    if "TMPDIR" in os.environ or not os.access(_MEMORY, os.W_OK | os.X_OK):
        return {}
    return {"TMPDIR": str(_MEMORY)} if shutil.disk_usage(_MEMORY).free >= _ENOUGH_BYTES else {}


def find_failures(status: int, path: Path) -> list[Failure] | None:
    """Return what failed in a run that ended with `status`; None if it broke off."""
    found = read_failures(path)
    return None if found is None or (status not in (0, NONE_COLLECTED) and not found) else found
