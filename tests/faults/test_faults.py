"""The table of faults (short version; `make test-faults` runs all)."""

from __future__ import annotations

import contextlib

import pytest

from tests.faults.all_faults import FAULTS
from tests.faults.ground import Ground
from tests.faults.mirrors import FLEET
from tests.faults.processes import ALL
from tests.faults.table import SMALL, done_to

SHORT = [fault for fault in FAULTS if fault.in_short]


# `make test` kills nodes in `test_kill.py`, `test_kill_coordinator.py`, `test_flow.py` and `test_mirror.py`.
@pytest.mark.long
@pytest.mark.parametrize("words", [SMALL, ALL, FLEET], ids=["map", "scene", "fleet"])
def test_nothing_is_lost_or_done_twice(tmp_path, subtests, words):
    """One system for all faults: starting one for each takes most of the time."""
    faults = [fault for fault in SHORT if fault.words == words and not fault.missing()]
    with contextlib.closing(Ground(tmp_path / "data", words)) as ground:
        for i, fault in enumerate(faults):
            with subtests.test(fault.name):
                if i:
                    ground.load_again()
                row = done_to(ground, fault, fault.in_short)
                assert (row.done, row.lost, row.doubled) == (fault.in_short, 0, 0)


def test_every_short_one_is_done():
    assert {fault.words for fault in SHORT} == {SMALL, ALL, FLEET}
