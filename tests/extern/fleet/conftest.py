"""Two robots that share a network: the second joins the first."""

from __future__ import annotations

import pytest

from tests.conftest import free_endpoint, running

BARE = ("--no-sim", "--no-record", "--abox", "none")


@pytest.fixture(scope="package")
def two_robots(tmp_path_factory):
    """arm1 has a cup, arm2 has none; both are reached at either endpoint."""
    data = tmp_path_factory.mktemp("robots")
    first = free_endpoint()
    with (
        running(data / "1", *BARE, "--namespace", "arm1", endpoint=first) as arm1,
        running(data / "2", *BARE, "--namespace", "arm2", "--connect", first) as arm2,
    ):
        arm1.cli("add", "Cup", "cup1", "--at", "1", "2", "0.7", "--namespace", "arm1")
        yield arm1, arm2
