from __future__ import annotations

import pytest


@pytest.fixture(scope="module")
def flat(flat_map):
    """The flat without a simulator, so that nothing moves. Each test restores it."""
    return flat_map
