"""A system for custom tests, as in the README."""

import pytest

from semmap.nodes.extern.client import connect
from semmap.nodes.extern.testing import free_endpoint, own_system


def test_a_system_is_there_for_a_test_and_gone_after_it(tmp_path):
    words, where = ("--no-sim", "--no-record"), free_endpoint()
    with own_system(tmp_path / "map", "--abox", "none", *words, endpoint=where) as semmap:
        semmap.add("Cup", "cup1", at=(1.0, 2.0, 0.7))
        with connect(where) as other:
            assert "Dishware" in other.get("cup1").types
    with own_system(tmp_path / "map", *words) as semmap:
        assert [entity.name for entity in semmap.list()] == ["cup1"]


def test_one_that_does_not_start_says_why(tmp_path):
    with (
        pytest.raises(RuntimeError, match=r"missing\.ttl"),
        own_system(tmp_path / "map", "--abox", str(tmp_path / "missing.ttl")),
    ):
        pass
