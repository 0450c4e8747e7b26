"""Stopping waits, because the knowledge base may be writing a checkpoint."""

from __future__ import annotations

import os
import signal
import sqlite3
import time
from contextlib import closing

from semmap.nodes.supervisor.watchdog import SILENT_S
from tests.conftest import PATIENCE_S, running, until

SLOW_S = SILENT_S + 2.0
"""Longer than any process may be silent while the system runs."""


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
