"""Run all faults, or those whose names contain a word: `python -m tests.faults [WORD...]`."""

from __future__ import annotations

import sys
import tempfile
import traceback
from pathlib import Path

from rich.console import Console
from rich.table import Table

from tests.faults.all_faults import FAULTS
from tests.faults.cut_hosts import CUTS
from tests.faults.table import Fault, Row, outcome


def main(words: list[str]) -> int:
    """Run the faults; returns 1 if a change was lost or doubled, or another guarantee was violated.

    With `--help`, or a word that is in no name, the names are printed instead.
    """
    names = [row.name for row in (*FAULTS, *CUTS)]
    if any(not any(word in name for name in names) for word in words):
        print(__doc__, *names, sep="\n")
        return 0 if "--help" in words else 2
    chosen = [fault for fault in FAULTS if not words or any(word in fault.name for word in words)]
    cuts = [several for several in CUTS if not words or any(word in several.name for word in words)]
    rows = [_row(fault) for fault in chosen]
    for several in cuts:
        print(f"{several.name} ...", file=sys.stderr, flush=True)
        rows += several.rows()
    console = Console(width=120)
    table = Table("fault", "times", "lost", "doubled", "recovered after [s]", "")
    for row in rows:
        remark = row.failed or (f"skipped: {row.skipped}" if row.skipped else "")
        whole = f"{row.whole_s:.1f}" if row.done else ""
        table.add_row(row.name, str(row.done), str(row.lost), str(row.doubled), whole, remark)
    console.print(table)
    lost, doubled = sum(row.lost for row in rows), sum(row.doubled for row in rows)
    failed = [row for row in rows if row.failed]
    if failed:
        print(f"violated guarantees: {len(failed)}")
    skipped = sum(bool(row.skipped) for row in rows)
    print(f"faults: {sum(row.done for row in rows)} done, {skipped} skipped, lost {lost}, doubled {doubled}")
    return 1 if failed or lost or doubled else 0


def _row(fault: Fault) -> Row:
    print(f"{fault.name} ...", file=sys.stderr, flush=True)
    with tempfile.TemporaryDirectory(prefix="semmap-faults-") as folder:
        try:
            row = outcome(fault, Path(folder, "data"), fault.often)
        except BaseException as error:
            if isinstance(error, KeyboardInterrupt):
                raise
            traceback.print_exc()
            return Row(fault.name, failed=str(error) or type(error).__name__)
    result = (
        row.skipped
        or f"{row.done} done, lost {row.lost}, doubled {row.doubled}, recovered after {row.whole_s:.1f} s"
    )
    print(f"    {result}", file=sys.stderr, flush=True)
    return row


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
