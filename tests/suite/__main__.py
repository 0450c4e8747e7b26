"""Run all tests but the long ones, then those again that need processes and failed: `python -m tests.suite`.

Arguments are passed to pytest.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

from tests.suite.pytest_runs import IN_PARALLEL, find_failures, run_pytest
from tests.suite.verdict import judge

ROOT = Path(__file__).resolve().parents[2]
_SHORT = ("-m", "not long")
_NAME_THE_SLOWEST = ("--durations=15", "--durations-min=1")


def main(words: list[str]) -> int:
    """Return the exit status: 0 if all tests passed, at once or, a few of them, when run again alone."""
    with tempfile.TemporaryDirectory(prefix="semmap-suite-") as folder:
        noted = Path(folder, "failures.json")
        status = run_pytest(*_SHORT, *_NAME_THE_SLOWEST, *IN_PARALLEL, *words, failures=noted)
        failures = find_failures(status, noted)
        if failures is None:
            return status or 1
        verdict = judge(failures, lambda name: _passes_alone(name, noted))
    print(*verdict.lines(), sep="\n", end="\n" if verdict.lines() else "", flush=True)
    return 0 if verdict.is_green else 1


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
