"""Backup, restore and compact of a running system."""

from __future__ import annotations

import json
import os
import signal
import threading
import time

import pytest

import semmap
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.storage.journal import FILENAME, Journal
from semmap.nodes.kb_node.storage.seed import seed
from semmap.ontology import HOUSEHOLD_TTL
from semmap.schemas import backups, errors
from tests.conftest import until
from tests.kb_node.home import chair, transaction

DAY_NS = 86_400 * 1_000_000_000


@pytest.fixture
def system(empty_map):
    """The shared system without a simulator, with an empty map at commit 1 for each test."""
    empty_map.begin_anew("none")
    return empty_map


def test_a_backup_of_a_system_that_goes_on_is_a_map_of_its_own(system, tmp_path):
    file, ended, added = tmp_path / "map.backup", threading.Event(), []

    def add():
        with system.client() as client:
            while not ended.is_set():
                added.append((reply := client.add("Cup", at=(len(added), 1.0, 0.0))).commit)
                assert reply.names

    adding = threading.Thread(target=add)
    adding.start()
    try:
        until(lambda: len(added) > 20, "cups")
        assert "verified" in system.cli("backup", file)
    finally:
        ended.set()
        adding.join()
    last = backups.verify(file).last
    assert added[0] < last < added[-1] + 1
    assert "already exists" in system.cli("backup", file, status=2)
    with system.client() as client:
        assert client.backup(file, overwrite=True).last == added[-1]
        last, there = added[-1], {entity.name for entity in client.list()}
    with pytest.raises(errors.Refused, match="a system is already running on"):
        semmap.restore(file, system.data, replace=True)
    running_already = system.cli("restore", file, "--data", system.data, "--replace", status=1)
    assert "a system is already running on" in running_already
    umask = os.umask(0o022)
    restored = semmap.restore(file, tmp_path / "three")
    assert (restored.opening.last, restored.entities, restored.kept) == (last, len(there), None)
    assert (tmp_path / "three" / FILENAME).stat().st_mode & 0o777 == 0o600
    assert os.umask(umask) == 0o022  # the program's own is as before
    told = system.cli("restore", file, "--data", tmp_path / "two")
    assert f"as it was after commit {last} " in told
    assert (tmp_path / "two" / FILENAME).stat().st_mode & 0o777 == 0o600
    system.open_map(tmp_path / "two")
    with system.client() as client:
        assert {entity.name for entity in client.list()} == there
        assert client.history(limit=1)[0].seq == last
        assert client.add("Cup", at=(0.0, 5.0, 0.0)).commit == last + 1


def test_compacting_a_system_that_goes_on(system, tmp_path, monkeypatch):
    now_ns = time.time_ns()
    with monkeypatch.context() as patch:
        patch.setattr("time.time_ns", lambda: now_ns - 41 * DAY_NS)
        seed(tmp_path, HOUSEHOLD_TTL, None)
        journal = Journal(tmp_path / FILENAME)
        semantic_map = SemanticMap(journal)
        for day in range(40, 0, -1):
            patch.setattr("time.time_ns", lambda day=day: now_ns - day * DAY_NS)
            one = chair(f"chair{day}", at=(3.0 * day, 2.0, 0.0))
            semantic_map.commit(transaction(day, one, reason=f"{day} days ago", verb="add"))
    first, last = journal.last - 39, journal.last
    journal.close()
    system.open_map(tmp_path)
    with system.client() as client:
        dry = json.loads(system.cli("compact", "--dry-run", "--format", "json"))
        assert dry["dry_run"]
        assert "would become a snapshot" in dry["text"]
        assert len(client.history(limit=1000)) == last
        before = {entity.name for entity in client.list()}
        compacted = client.compact(keep="720h")
        assert (compacted.first, compacted.commits) == (dry["first"], dry["commits"])
        assert compacted.first == first + 11
        history = client.history(limit=1000)
        assert [commit.seq for commit in history] == list(range(compacted.first - 1, last + 1))
        assert history[0].reason.startswith("the history begins here, with ")
        assert {entity.name for entity in client.list()} == before
        with pytest.raises(errors.Refused, match="have been compacted: the history begins with the map at"):
            client.list(as_of=compacted.first - 2)
        with pytest.raises(errors.Refused, match="cannot be undone: it has been compacted"):
            client.undo(compacted.first - 2)
        assert len(client.list(as_of=compacted.first)) == 12
        client.undo(last)
        assert "is not an age; examples: 12h, 30d" in system.cli("compact", "--keep", "x", status=2)
        assert "no commit is older" in system.cli("compact")
    pid = system.pid("kb_node")
    os.kill(pid, signal.SIGKILL)
    until(lambda: system.pid("kb_node") not in (0, pid), "it opens the map again")
    with system.client() as client:
        assert {entity.name for entity in client.list()} == before - {"chair1"}
        assert client.history()[0].seq == compacted.first - 1
