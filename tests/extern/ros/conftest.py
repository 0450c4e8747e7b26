from __future__ import annotations

import pytest

from tests.conftest import running


@pytest.fixture(scope="session")
def flat(tmp_path_factory):
    """The flat, without a simulator: what is told of it does not move. Each test puts it back as it was."""
    with running(tmp_path_factory.mktemp("ros"), "--no-sim", "--no-record") as system:
        yield system
