"""The table of faults in its short form; `make test-faults` does all of it."""

from __future__ import annotations

import contextlib

from tests.faults.all_faults import FAULTS
from tests.faults.ground import Ground
from tests.faults.processes import ALL
from tests.faults.table import done_to


def test_nothing_is_lost_or_done_twice(tmp_path, subtests):
    """One whole system bears all of them, one after another: starting one for each takes most of the time."""
    with contextlib.closing(Ground(tmp_path / "data", ALL)) as ground:
        for i, fault in enumerate(fault for fault in FAULTS if fault.in_short and not fault.missing()):
            with subtests.test(fault.name):
                if i:
                    ground.load_again()
                row = done_to(ground, fault, fault.in_short)
                assert (row.done, row.lost, row.doubled) == (fault.in_short, 0, 0)
