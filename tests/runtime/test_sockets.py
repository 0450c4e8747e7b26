"""Tests of where Unix sockets are."""

from __future__ import annotations

import os
import socket
import tempfile
from pathlib import Path

import pytest

from semmap.nodes.runtime.sockets import socket_folder


@pytest.fixture
def short():
    """A folder with a short path: that of `tmp_path` may be longer than a socket's."""
    with tempfile.TemporaryDirectory(dir="/tmp", prefix="s") as folder:
        yield Path(folder)


def test_sockets_are_in_the_temporary_folder(short, monkeypatch):
    monkeypatch.setattr(tempfile, "tempdir", str(short))
    assert socket_folder("viser.sock") == short


@pytest.mark.parametrize("length", [90, 100, 101, 107, 108, 200])
def test_a_socket_can_be_bound_however_long_the_temporary_folder_is(short, monkeypatch, length):
    name = f"a{os.getpid()}.sock"
    folder = short / ("x" * (length - len(f"{short}//{name}")))
    folder.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    path = socket_folder(name) / name
    with socket.socket(socket.AF_UNIX) as listening:
        listening.bind(str(path))
    path.unlink()
    assert (path.parent == folder) == (length <= 100)
