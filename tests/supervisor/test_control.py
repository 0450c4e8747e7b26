"""Odd paths, and stopping, which waits, because the knowledge base may be writing a checkpoint."""

from __future__ import annotations

import os
import shlex
import signal
import sqlite3
import subprocess
import tempfile
import time
from contextlib import closing

import pytest
from supervisor.options import ServerOptions

from semmap.nodes.supervisor.control import Supervisor
from semmap.nodes.supervisor.settings import Settings
from semmap.nodes.supervisor.watchdog import SILENT_S
from tests.conftest import PATIENCE_S, running, until

SLOW_S = SILENT_S + 2.0
"""Longer than any process may be silent while the system runs."""


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


def test_stopping_waits_for_a_slow_knowledge_base(tmp_path):
    data = tmp_path / "data"
    with running(data, "--abox", "none", "--no-sim", "--no-record") as system:
        system.cli("add", "Cup", "cup1", "--at", "1", "2", "0")
        pid = system.pid("kb_node")
        os.kill(pid, signal.SIGSTOP)
        with system.spawned("down", "--data", str(data)) as down:
            time.sleep(SLOW_S)
            os.kill(pid, signal.SIGCONT)
            down.communicate(timeout=PATIENCE_S)
        assert down.returncode == 0
        assert system.process.wait(timeout=PATIENCE_S) == 0
        until(lambda: system.said[-1] == "stopped\n", "its last log line")
        assert not any("does not answer" in line for line in system.said)
    with closing(sqlite3.connect(data / "journal.sqlite")) as journal:
        ((checkpoint, last),) = journal.execute(
            "SELECT (SELECT max(seq) FROM checkpoints), (SELECT max(seq) FROM commits)"
        )
    assert checkpoint == last >= 2
