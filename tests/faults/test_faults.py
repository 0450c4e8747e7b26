"""The table of faults in its short form; `make test-faults` does all of it."""

from __future__ import annotations

import pytest

from tests.faults.all_faults import FAULTS
from tests.faults.table import outcome


@pytest.mark.parametrize("fault", [f for f in FAULTS if f.in_short], ids=lambda fault: fault.name)
def test_nothing_is_lost_or_done_twice(tmp_path, fault):
    row = outcome(fault, tmp_path / "data", fault.in_short)
    if row.skipped:
        pytest.skip(row.skipped)
    assert (row.done, row.lost, row.doubled) == (fault.in_short, 0, 0)
