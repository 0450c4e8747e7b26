"""The verdict on a run of the suite, after failed process tests have been run again."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from tests.suite.failures import Failure

MOST_FLAKY = 2
"""More tests that pass only when they are run again are a failure."""
_MOST_AGAIN = 10
"""Where more have failed, something is broken, and running them again would only take long."""


@dataclass(frozen=True)
class Verdict:
    """Which tests failed, and which of them passed when they were run again, alone."""

    failed: tuple[str, ...] = ()
    flaky: tuple[str, ...] = ()

    @property
    def is_green(self) -> bool:
        """Whether nothing failed but a few flaky tests."""
        return not self.failed and len(self.flaky) <= MOST_FLAKY

    def lines(self) -> list[str]:
        """Return what is printed at the end: nothing for a run in which all passed."""
        said = [f"flaky: {name}" for name in self.flaky]
        if len(self.flaky) > MOST_FLAKY:
            said.append(f"failed: {len(self.flaky)} flaky tests; at most {MOST_FLAKY} are tolerated")
        return said


def judge(failures: list[Failure], run_again: Callable[[str], bool]) -> Verdict:
    """Return the verdict on a run with these failures.

    `run_again` runs a test alone and returns whether it passes. A test that needs no process is never run
    again; where one has failed, or very many, no other is.
    """
    names = tuple(failure.name for failure in failures)
    if len(failures) > _MOST_AGAIN or not all(failure.needs_process for failure in failures):
        return Verdict(failed=names)
    flaky = tuple(name for name in names if run_again(name))
    return Verdict(failed=tuple(name for name in names if name not in flaky), flaky=flaky)
