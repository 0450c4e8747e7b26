"""Tests that need processes are detected from their code, and other tests cannot start one."""

from __future__ import annotations

import os
import pkgutil
import subprocess
import sys

import pytest

from semmap.nodes import bus
from semmap.nodes.extern.client import connect
from tests import conftest, tiers


def _pure():
    return len(sys.argv), os.getpid(), conftest.PATIENCE_S


def _runs_a_program():
    subprocess.run(["true"], check=True)


def _opens_a_session():
    with bus.open_session(bus.Network()):
        pass


def _connects():
    return connect("tcp/127.0.0.1:1")


def _uses_another():
    return [_connects for _ in range(2)]


def _starts_a_system(tmp_path):
    with conftest.running(tmp_path):
        pass


class _Server:
    def start(self):
        _runs_a_program()


def _has_a_server():
    return _Server()


@pytest.mark.parametrize(
    "function",
    [_runs_a_program, _opens_a_session, _connects, _uses_another, _starts_a_system, _has_a_server],
)
def test_what_starts_a_process_or_opens_a_session_is_found(function):
    assert tiers.uses_any([_pure, function], tiers.STARTERS)


def test_what_does_neither_is_pure():
    assert not tiers.uses_any([_pure], tiers.STARTERS)


@pytest.mark.parametrize("name", sorted(tiers.STARTERS))
def test_every_starter_exists_under_its_name(name):
    found = pkgutil.resolve_name(_resolvable(name))
    assert tiers._name(found) == name


def _resolvable(name):
    """The method of the default context is bound, where it is used."""
    context = "multiprocessing.context.DefaultContext.get_context"
    return "multiprocessing:get_context" if name == context else name


def test_a_pure_test_cannot_start_a_process(monkeypatch):
    monkeypatch.setattr(tiers, "_is_pure", True)
    with pytest.raises(RuntimeError, match="not marked"):
        subprocess.run(["true"], check=True)


def test_processes_of_libraries_are_ignored(monkeypatch, tmp_path):
    monkeypatch.setattr(tiers, "_is_pure", True)
    library = tmp_path / "site-packages" / "library.py"
    code = compile("import subprocess\nended = subprocess.run(['true'])", str(library), "exec")
    names = {}
    exec(code, names)
    assert names["ended"].returncode == 0
