"""A system for custom tests, as in the README; `test_stored_map.py` has one that starts."""

import pytest

from semmap.nodes.extern.testing import own_system


def test_one_that_does_not_start_says_why(tmp_path):
    with (
        pytest.raises(RuntimeError, match=r"missing\.ttl"),
        own_system(tmp_path / "map", "--abox", str(tmp_path / "missing.ttl")),
    ):
        pass
