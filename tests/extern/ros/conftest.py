from __future__ import annotations

import pytest

from tests.conftest import running


@pytest.fixture(scope="session")
def flat(tmp_path_factory):
    """The flat without a simulator, so that nothing moves. Each test restores it."""
    with running(tmp_path_factory.mktemp("ros"), "--no-sim", "--no-record") as system:
        yield system
