"""Run the tests that need processes many times: `python -m tests.suite.repeats [--times N] [--load LOAD]`.

Each time, they run in another order, beside as many busy loops as told. What pytest prints goes to files.
"""

from __future__ import annotations

import argparse
import contextlib
import random
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

from tests.suite.failures import Failure
from tests.suite.pytest_runs import IN_PARALLEL, find_failures, run_pytest

_ROOT = Path(__file__).resolve().parents[2]


def main(words: list[str] | None = None) -> int:
    """Print a line for each test that failed; exit status 1 if one did."""
    parser = argparse.ArgumentParser(prog="make test-flaky", description=__doc__)
    parser.add_argument("--times", type=int, default=10)
    parser.add_argument("--load", type=int, default=0)
    parser.add_argument("--seed", type=int, default=random.SystemRandom().randrange(1_000_000))
    parser.add_argument("words", nargs="*", help="words for pytest, after --")
    chosen = parser.parse_args(words)
    folder = _ROOT / "dist" / "flaky"
    folder.mkdir(parents=True, exist_ok=True)
    print(f"seed {chosen.seed}, load {chosen.load}; output in {folder}", file=sys.stderr, flush=True)
    failures: list[Failure] = []
    with busy_loops(chosen.load):
        for time in range(chosen.times):
            found = _run(folder / f"run{time + 1}.txt", chosen.seed + time, chosen.words)
            print(f"run {time + 1} of {chosen.times}: {len(found)} failed", file=sys.stderr, flush=True)
            failures += found
    for line in write_table(failures, chosen.times):
        print(line)
    return 1 if failures else 0


def write_table(failures: list[Failure], times: int) -> list[str]:
    """Return a line for each test that failed, how often it did, and its first message; most often first."""
    counts = Counter(failure.name for failure in failures)
    first: dict[str, str] = {}
    for failure in failures:
        first.setdefault(failure.name, failure.message)
    return [f"{name}  {count} of {times}  {first[name]}" for name, count in counts.most_common()]


@contextlib.contextmanager
def busy_loops(number: int) -> Iterator[list[subprocess.Popen[bytes]]]:
    """As many processes that do nothing but work, ended afterwards."""
    loops = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(number)]
    try:
        yield loops
    finally:
        for loop in loops:
            loop.kill()
            loop.wait()


def _run(log: Path, seed: int, words: list[str]) -> list[Failure]:
    """Run the tests once; what failed. A run that broke off is a failure by the name of its log."""
    noted = log.with_suffix(".json")
    noted.unlink(missing_ok=True)
    chosen = ("-m", "process and not long", "--shuffle", str(seed), *IN_PARALLEL, *words)
    with log.open("wb") as output:
        status = run_pytest(*chosen, failures=noted, output=output)
    found = find_failures(status, noted)
    broke_off = Failure(str(log), needs_process=True, message=f"pytest ended with status {status}")
    return [broke_off] if found is None else found


if __name__ == "__main__":
    raise SystemExit(main())
