"""The report on tested mutants."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

from tests.mutants.mirror import OwnTests
from tests.mutants.sample import Mutant
from tests.mutants.trial import BROKEN, KILLED, NO_TEST, SURVIVED, TIMEOUT


@dataclass(frozen=True)
class Tried:
    """A mutant, its tests and its outcome."""

    mutant: Mutant
    tests: OwnTests
    outcome: str


def write_report(part: str, seed: int, tried: list[Tried]) -> str:
    """Return the survivors, by file, and the share of mutants that were killed.

    A mutant without a test counts as a survivor. One whose tests fail without it, too, does not count.
    """
    counts = Counter(one.outcome for one in tried)
    lines = [
        f"{one.outcome:8}  {one.mutant.describe()}  [{_name(one.tests)}]"
        for outcome in (BROKEN, NO_TEST, SURVIVED)
        for one in sorted(tried, key=lambda one: (one.mutant.path, one.mutant.line))
        if one.outcome == outcome
    ]
    killed = counts[KILLED] + counts[TIMEOUT]
    counted = len(tried) - counts[BROKEN]
    share = f"{killed / counted:.0%}" if counted else "none"
    lines.append(
        f"{part}, seed {seed}: {killed} of {counted} mutants killed ({share}), {counts[SURVIVED]} survived,"
        f" {counts[NO_TEST]} without a test"
    )
    return "\n".join(lines)


def _name(tests: OwnTests) -> str:
    return tests.files[0] if tests.is_mirrored else f"{len(tests.files)} files of the folder"
