"""A system on two hosts whose link is cut (short version; `make test-faults` runs all)."""

from __future__ import annotations

import pytest

from tests.faults import hosts
from tests.faults.cut_hosts import Cuts


@pytest.mark.long
@pytest.mark.skipif(hosts.missing() != "", reason=f"hosts cannot be created: {hosts.missing()}")
def test_a_link_between_hosts_is_cut():
    (row,) = Cuts("link cut", 2.5, ("--small", "--how", "silent")).rows()
    assert (row.done, row.lost, row.doubled, row.failed) == (1, 0, 0, "")
