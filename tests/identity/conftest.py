"""A folder of keys, created once because that is slow."""

from __future__ import annotations

import shutil

import pytest

from semmap.nodes.identity import authority


@pytest.fixture(scope="session")
def made_once(tmp_path_factory):
    folder = tmp_path_factory.mktemp("keys") / "K"
    authority.init(folder, ("robot.local", "192.168.7.1"))
    authority.add(folder, "vera", "viewer")
    return folder


@pytest.fixture
def folder(made_once, tmp_path):
    """A copy that a test may change."""
    return shutil.copytree(made_once, tmp_path / "K")
