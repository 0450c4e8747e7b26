"""Run all tests but the long ones, then those again that need processes and failed: `python -m tests.suite`.

Arguments are passed to pytest. The parts run side by side; what the second prints comes after the first.
"""

from __future__ import annotations

import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from tests.suite.failures import Failure
from tests.suite.parts import PARTS, find_failures, run_pytest
from tests.suite.verdict import judge

ROOT = Path(__file__).resolve().parents[2]
_SHORT = ("-m", "not long")
_NAME_THE_SLOWEST = ("--durations=15", "--durations-min=1")


def main(words: list[str]) -> int:
    """Return the exit status: 0 if all tests passed, at once or, a few of them, when run again alone."""
    with (
        tempfile.TemporaryDirectory(prefix="semmap-suite-") as folder,
        ThreadPoolExecutor(len(PARTS)) as pool,
    ):
        parts = [_Part(part, words, Path(folder, f"part{number}")) for number, part in enumerate(PARTS)]
        runs = [pool.submit(part.run, is_shown=number == 0) for number, part in enumerate(parts)]
        failures: list[Failure] = []
        for part, run in zip(parts, runs, strict=True):
            status = run.result()
            part.show()
            found = find_failures(status, part.failures)
            if found is None:
                return status or 1
            failures += found
        verdict = judge(failures, lambda name: _passes_alone(name, Path(folder, "again.json")))
    print(*verdict.lines(), sep="\n", end="\n" if verdict.lines() else "", flush=True)
    return 0 if verdict.is_green else 1


class _Part:
    """One run of pytest and its files."""

    def __init__(self, part: tuple[str, ...], words: list[str], stem: Path) -> None:
        self._arguments = (*_SHORT, *_NAME_THE_SLOWEST, *words, *part)
        self._output = stem.with_suffix(".txt")
        self.failures = stem.with_suffix(".json")

    def run(self, is_shown: bool) -> int:
        """Run pytest and return its exit status; the output is shown at once or kept for `show`."""
        if is_shown:
            return run_pytest(*self._arguments, failures=self.failures)
        with self._output.open("wb") as output:
            return run_pytest(*self._arguments, failures=self.failures, output=output)

    def show(self) -> None:
        """Print the output that was kept."""
        if self._output.exists():
            sys.stdout.write(self._output.read_text(errors="replace"))
            sys.stdout.flush()


def _passes_alone(name: str, failures: Path) -> bool:
    """Run a test alone; print what pytest prints if it fails again."""
    with tempfile.TemporaryFile() as output:
        status = run_pytest(name, failures=failures, output=output)
        if status:
            output.seek(0)
            sys.stdout.write(output.read().decode(errors="replace"))
    return status == 0


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
