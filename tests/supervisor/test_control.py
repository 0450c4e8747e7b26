"""Odd paths, and what is known of a supervisord that ended."""

from __future__ import annotations

import os
import shlex
import subprocess
import tempfile

import pytest
from supervisor.options import ServerOptions

from semmap.nodes.supervisor.control import Supervisor
from semmap.nodes.supervisor.settings import Settings


@pytest.mark.parametrize(
    "name", ["a b", "100% %(here)s %d", "\"a'b", "$HOME ;b #c [d]", "ä日本", "two\nlines", "x" * 200]
)
def test_supervisord_gets_every_path_as_it_is(tmp_path, monkeypatch, name):
    """Its configuration is read by its own parser, in which many characters have a meaning."""
    started = {}
    monkeypatch.setattr(subprocess, "Popen", lambda words, **options: started.update(options, words=words))
    supervisor = Supervisor(tmp_path / name)
    settings = Settings(data=str(tmp_path / name), tbox="t", abox=None, world="w")
    supervisor.start(settings)
    for variable, value in started["env"].items():
        monkeypatch.setenv(variable, value)
    options = ServerOptions()
    options.realize(started["words"][4:])
    assert options.logfile == str(supervisor.logs / "supervisord.log")
    assert [server["file"] for server in options.server_configs] == [str(supervisor.socket)]
    nodes = {node.name: node for group in options.process_group_configs for node in group.process_configs}
    assert set(nodes) == set(settings.nodes)
    for node, program in nodes.items():
        assert shlex.split(program.command)[-2:] == [node, str(tmp_path / name / "settings.json")]
        assert program.stdout_logfile == str(supervisor.log_of(node))


def test_sockets_have_short_paths(tmp_path, monkeypatch):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / ("x" * 100)))
    supervisor = Supervisor(tmp_path / ("ä" * 100))
    for path in (supervisor.socket, supervisor.notices):
        assert len(os.fsencode(path)) <= 100
    assert supervisor.socket != Supervisor(tmp_path).socket


def test_the_reason_of_supervisord_for_ending_is_returned(tmp_path):
    supervisor = Supervisor(tmp_path)
    assert supervisor.last_error() == ""
    supervisor.logs.mkdir()
    (supervisor.logs / "supervisord.out").write_text("a line\nError: too few processes\nFor help, use -h\n")
    assert supervisor.last_error() == " (too few processes)"
