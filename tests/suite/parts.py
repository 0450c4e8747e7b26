"""The runs of pytest that make up the suite."""

from __future__ import annotations

import contextlib
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import IO

from tests.suite.failures import Failure, read_failures

PARTS: tuple[tuple[str, ...], ...] = (
    ("-n", "3", "--dist", "worksteal", "--ignore", "tests/page"),  # on two cores: many wait for a system
    ("tests/page",),  # in one process: they share a browser
)
"""Words for pytest, which runs all parts at the same time."""
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


def run_parts(*words: str, folder: Path) -> list[tuple[int, list[Failure] | None]]:
    """Run all parts at the same time; return the exit status of each, and what failed, None if it broke off.

    The first prints as it goes on, and the others when it has ended. `folder` is for files in between.
    """
    noted = [folder / f"failures{number}.json" for number, _ in enumerate(PARTS)]
    with ThreadPoolExecutor() as executor, contextlib.ExitStack() as files:
        outputs = [files.enter_context(tempfile.TemporaryFile(dir=folder)) for _ in PARTS[1:]]
        beside = [
            executor.submit(run_pytest, *words, *part, failures=path, output=output)
            for part, path, output in zip(PARTS[1:], noted[1:], outputs, strict=True)
        ]
        statuses = [run_pytest(*words, *PARTS[0], failures=noted[0])]
        for run, output in zip(beside, outputs, strict=True):
            statuses.append(run.result())
            output.seek(0)
            print(output.read().decode(errors="replace"), end="", flush=True)
    return [(status, find_failures(status, path)) for status, path in zip(statuses, noted, strict=True)]


def find_failures(status: int, path: Path) -> list[Failure] | None:
    """Return what failed in a run that ended with `status`; None if it broke off."""
    found = read_failures(path)
    return None if found is None or (status not in (0, NONE_COLLECTED) and not found) else found
