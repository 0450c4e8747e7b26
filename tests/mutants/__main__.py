"""Change lines of a part at random, and list the changes that its own tests do not notice.

`python -m tests.mutants PART [--number N] [--seed SEED] [--jobs JOBS]`.
"""

from __future__ import annotations

import argparse
import queue
import sys
import threading
from pathlib import Path

from tests.mutants.ledger import Ledger
from tests.mutants.mirror import find_own_tests
from tests.mutants.report import Tried, write_report
from tests.mutants.sample import Mutant, draw
from tests.mutants.trial import BROKEN, Copy

PARTS = tuple(
    f"nodes/{name}" for name in ("language", "kb_node", "coordinator", "perception_node", "sim_node")
)
_ROOT = Path(__file__).resolve().parents[2]


def main(words: list[str] | None = None) -> int:
    """Print the survivors of each part; exit status 1 if tests fail without a change."""
    parser = argparse.ArgumentParser(prog="make mutants", description=__doc__)
    parser.add_argument("parts", nargs="*", default=PARTS, metavar="PART")
    parser.add_argument("--number", type=int, default=60)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2)
    chosen = parser.parse_args(words)
    work = _ROOT / "dist" / "mutants"
    copies = [Copy(_ROOT, work / f"copy{job}") for job in range(chosen.jobs)]
    ledger = Ledger(_ROOT, work / "outcomes.jsonl")
    tried: list[Tried] = []
    for part in chosen.parts:
        mutants = draw(_ROOT, part, chosen.number, chosen.seed)
        of_part = _try(mutants, copies, ledger)
        print(write_report(part, chosen.seed, of_part), flush=True)
        tried += of_part
    return 1 if any(one.outcome == BROKEN for one in tried) else 0


def _try(mutants: list[Mutant], copies: list[Copy], ledger: Ledger) -> list[Tried]:
    """Try all mutants, in as many copies at a time as there are."""
    waiting: queue.SimpleQueue[Mutant] = queue.SimpleQueue()
    for mutant in mutants:
        waiting.put(mutant)
    done: list[Tried] = []

    def work(copy: Copy) -> None:
        while not waiting.empty():
            try:
                mutant = waiting.get_nowait()
            except queue.Empty:
                return
            tests = find_own_tests(_ROOT, mutant.path)
            outcome = ledger.find(mutant, tests)
            if outcome is None:
                outcome = copy.try_mutant(mutant, tests)
                if outcome != BROKEN:
                    ledger.note(mutant, tests, outcome)
            done.append(Tried(mutant, tests, outcome))
            print(f"{len(done)}/{len(mutants)} {outcome}: {mutant.describe()}", file=sys.stderr, flush=True)

    threads = [threading.Thread(target=work, args=(copy,), daemon=True) for copy in copies]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return done


if __name__ == "__main__":
    raise SystemExit(main())
