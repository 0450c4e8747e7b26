"""A system on two hosts whose link is cut, in its short form; `make test-faults` does all of it."""

from __future__ import annotations

import pytest

from tests.faults import hosts
from tests.faults.cut_hosts import Cuts


@pytest.mark.skipif(hosts.missing() != "", reason=f"no hosts of one's own: {hosts.missing()}")
def test_a_link_between_hosts_is_cut():
    (row,) = Cuts("link cut", 2.5, ("--small", "--how", "silent")).rows()
    assert (row.done, row.lost, row.doubled, row.failed) == (1, 0, 0, "")
