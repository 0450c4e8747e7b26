"""A full disk: commits are rejected, the system reports it, and continues when there is space again."""

from __future__ import annotations

import resource
from contextlib import contextmanager

import pytest

from semmap.schemas import errors
from tests.conftest import until


@contextmanager
def full(data, pid):
    """The operating system lets the process write nowhere beyond the size of the journal.

    Its log is longer from the beginning.
    """
    size = (data / "journal.sqlite").stat().st_size
    limits = resource.prlimit(pid, resource.RLIMIT_FSIZE)
    resource.prlimit(pid, resource.RLIMIT_FSIZE, (size, limits[1]))
    try:
        yield
    finally:
        resource.prlimit(pid, resource.RLIMIT_FSIZE, limits)


def node(client):
    return next(n for n in client.status().nodes if n.node == "kb_node")


def fill(client):
    """Commits of 40 kB each, more than the journal has room for."""
    for i in range(20):
        alt = tuple(f"{i:02}" * 450 + f" {n}" for n in range(20))
        client.add("Chair", f"big{i}", at=(2.0, i, 0.0), alt=alt)


def test_commits_are_refused_until_there_is_space_again(empty_map):
    with empty_map.client() as client:
        client.add("Chair", "chair1", at=(1.0, 1.0, 0.0))
        before = node(client)
        with full(empty_map.data, before.pid):
            with pytest.raises(errors.Refused, match=r"commit \d+ could not be written to .*journal\.sqlite"):
                fill(client)
            there = {e.name for e in client.list()}
            assert "chair1" in there
            assert client.check().consistent
            status = until(
                lambda: (now := node(client)).last_error and now, "the status says that the disk is full"
            )
            assert "could not be written" in status.last_error
            assert status.detail.endswith("the disk accepts no commits")
            assert (status.pid, status.state) == (before.pid, "ready")
        seq = client.status().commit
        assert client.add("Chair", "chair2", at=(3.0, 1.0, 0.0)).commit == seq + 1
        assert {e.name for e in client.list()} == there | {"chair2"}
        until(lambda: not node(client).detail.endswith("the disk accepts no commits"), "all is well again")
