"""Errors at the start are reported in one line, and existing data is not changed."""

from __future__ import annotations

import contextlib
import io
import os
import resource
import signal
import socket
import sqlite3
import subprocess
import sys
import tempfile
import threading
import time
from contextlib import closing
from pathlib import Path

import pytest

from semmap.nodes import bus
from semmap.nodes.extern.cli.app import execute
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.storage.journal import Journal
from semmap.nodes.kb_node.storage.seed import seed
from semmap.nodes.supervisor.control import Supervisor
from semmap.nodes.supervisor.settings import JOURNAL, SETTINGS, Settings
from semmap.nodes.supervisor.up import _Foreground, require_files
from semmap.nodes.supervisor.watchdog import SILENT_S
from semmap.ontology import FLAT_TTL, HOUSEHOLD_TTL
from semmap.ontology import vocabulary as v
from semmap.schemas import errors
from tests.conftest import PATIENCE_S, free_endpoint, running, until
from tests.household import household_classes

SLOW_S = SILENT_S + 2.0
"""Longer than any process may be silent while the system runs."""
BASE = "http://www.semanticweb.org/ontologies/2016/1/semantic_mapping"


def up(data: Path, *words: str | Path) -> tuple[int, str]:
    """Run a failing `semmap up` in this process; return its exit status and the last line of stderr."""
    printed = io.StringIO()
    with contextlib.redirect_stderr(printed):
        status = execute(["up", "--data", str(data), "--listen", free_endpoint(), *map(str, words)])
    lines = printed.getvalue().strip().splitlines()
    assert len(lines) == 1, printed.getvalue()
    return status, lines[0]


def down(*words: str | Path) -> tuple[int, str]:
    """Return the exit status and output of `semmap down`."""
    command: list[str | Path] = [Path(sys.executable).parent / "semmap", "down", *words]
    run = subprocess.run(command, capture_output=True, text=True, timeout=2 * PATIENCE_S)
    return run.returncode, (run.stdout + run.stderr).strip()


@pytest.mark.process
@pytest.mark.parametrize(
    ("abox", "status", "said"),
    [
        (FLAT_TTL.read_text()[:3000], 2, "not valid Turtle"),
        (f"<{BASE}_1#a> a <{BASE}_domain_model#Chair>, <{BASE}_domain_model#Kitchen> .", 1, "cannot be both"),
    ],
)
def test_a_bad_abox_stops_the_start_and_leaves_existing_data_alone(tmp_path, abox, status, said):
    data, file = tmp_path / "data", tmp_path / "bad.ttl"
    file.write_text(abox)
    ended, line = up(data, "--abox", file)
    assert ended == status
    assert said in line
    assert "bad.ttl" in line
    assert not (data / JOURNAL).exists()


@pytest.mark.process
def test_a_fresh_start_that_fails_keeps_the_old_map(tmp_path):
    data, file = tmp_path / "data", tmp_path / "bad.ttl"
    file.write_text("hello")
    old = tmp_path / "old.ttl"
    old.write_text(f"<{BASE}_1#chair1> a <{BASE}_domain_model#Chair> .")
    seed(data, HOUSEHOLD_TTL, old, fresh=False)
    before = (data / JOURNAL).read_bytes()
    assert up(data, "--abox", file, "--fresh")[0] == 2
    assert (data / JOURNAL).read_bytes() == before
    journal = Journal(data / JOURNAL)
    assert [entity.name for entity in SemanticMap(journal).entities()] == ["chair1"]
    journal.close()


@pytest.mark.process
def test_an_unreadable_map_is_reported_before_the_start(tmp_path):
    (tmp_path / JOURNAL).write_bytes(b"")
    status, line = up(tmp_path)
    assert status == 1
    assert "cannot be read" in line


@pytest.mark.process
def test_a_bad_world_is_reported_before_a_map_is_created(tmp_path):
    world = tmp_path / "world.xml"
    world.write_text("<mujoco")
    status, line = up(tmp_path / "data", "--abox", "none", "--world", world)
    assert status == 2
    assert "world.xml" in line
    assert not (tmp_path / "data" / JOURNAL).exists()


@pytest.mark.process
def test_a_port_in_use_is_reported(tmp_path):
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        endpoint = f"tcp/127.0.0.1:{taken.getsockname()[1]}"
        status, line = up(tmp_path, "--listen", endpoint)
    assert status == 1
    assert f"cannot listen on {endpoint}" in line
    assert "for example --listen tcp/127.0.0.1:" in line


def test_too_few_open_files_are_reported(monkeypatch):
    monkeypatch.setattr(resource, "getrlimit", lambda _: (200, 200))
    with pytest.raises(
        errors.Refused, match=r"may open 200 files here, and semmap needs 1,024; .*ulimit -n 1024"
    ):
        require_files()
    monkeypatch.setattr(resource, "getrlimit", lambda _: (200, resource.RLIM_INFINITY))
    require_files()


@pytest.mark.process
@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--abox", "nowhere.ttl"), "there is no file nowhere.ttl"),
        (("--abox", "/"), "is a directory"),
        (("--tbox", "nowhere.ttl"), "there is no file"),
        (("--models", "nowhere"), "nowhere is not a folder"),
        (("--abox", Path("demo", "picnic.json")), "semmap load"),
        (("--abox", Path("demo", "house.hrc")), "semmap load"),
        (("--threshold", "-1"), "--threshold must be"),
        (("--camera-size", "0", "0"), "--camera-size: the 1st must be"),
        (("--truth", "god"), "god"),
        (("--listen", "7450"), "'7450' is not a valid endpoint; use tcp/HOST:PORT"),
        (("--connect", "tcp/127.0.0.1:99999"), "'tcp/127.0.0.1:99999' is not a valid endpoint"),
        (("--data", "/etc/hosts"), "/etc/hosts"),
    ],
)
def test_bad_options_are_reported(tmp_path, words, said):
    status, line = up(tmp_path, *words)
    assert status == 2
    assert said in line


def test_ontologies_start_with_their_imports_and_notes(tmp_path):
    home, own = tmp_path / "home.ttl", tmp_path / "own"
    home.write_text(HOUSEHOLD_TTL.read_text())
    own.mkdir()
    (own / "stools.omn").write_text(
        f"Prefix: dm: <{v.TBOX}>\nOntology: <http://o.org/stools>\nImport: <http://o.org/home>\n"
        "Import: <http://o.org/nowhere>\nClass: dm:Chair\nClass: dm:Barstool\n    SubClassOf: dm:Chair\n"
    )
    (own / "more.ofn").write_text(f"Ontology(<http://o.org/more> Declaration(Class(<{v.TBOX}Pouffe>)))")
    data = tmp_path / "data"
    words = ("--tbox", own, "--import", f"http://o.org/home={home}", "--no-sim", "--no-record")
    note = "1 import was not found; the TBox is used without: http://o.org/nowhere"
    for also in (words, words[-2:]):  # the second time it continues with the existing map
        with running(data, *also) as system, system.client() as client:
            assert any(line.startswith("TBox ") and line.strip().endswith(note) for line in system.said)
            assert {"Barstool", "Pouffe", "Chair"} <= {c.name for c in client.classes()}
            assert client.add("Barstool").commit
            assert note in next(node for node in client.status().nodes if node.node == "kb_node").notes
            assert len(client.list("Chair")) == (1 if also is words else 2)


@pytest.mark.process
def test_an_unreadable_ontology_is_reported(tmp_path):
    (tmp_path / "own.ofn").write_text("Ontology(<urn:o>\n\n  Nonsense())")
    status, line = up(tmp_path / "data", "--tbox", tmp_path / "own.ofn")
    assert status == 2
    assert "own.ofn is not valid OWL functional syntax: line 3 cannot be read" in line


def test_a_model_file_without_class_is_reported(tmp_path, monkeypatch):
    models, said = tmp_path / "models", []
    models.mkdir()
    (models / "chiar.obj").write_text("")
    replies = {"classes": household_classes(), "list": ()}
    monkeypatch.setattr(bus, "ask", lambda session, prefix, verb, *ignored: replies[verb])
    settings = Settings(data=str(tmp_path), tbox="", abox=None, world="", models=str(models))
    foreground = _Foreground(Supervisor(tmp_path), settings, None, None, said.append)
    foreground._report_models(None)
    (line,) = said
    assert "ignored, because no class has a model with this name: chiar.obj (did you mean chair" in line


def test_a_system_is_the_only_one_of_its_folder_and_is_stopped_by_its_endpoint(tmp_path, monkeypatch):
    """The modules in the working directory do not matter, and another version can stop it.

    Stopping waits for a slow knowledge base, because it may be writing a checkpoint.
    """
    folder = tmp_path / "mine"
    folder.mkdir()
    for module in ("queue", "nodes", "supervisor"):
        (folder / f"{module}.py").write_text("raise RuntimeError('not this one')\n")
    monkeypatch.chdir(folder)
    monkeypatch.setenv("TMPDIR", str(tmp_path))  # which has the registry: of many systems not all are named
    monkeypatch.setattr(tempfile, "tempdir", None)
    data = tmp_path / "my map"
    with running(data, "--abox", "none", "--no-sim", "--no-record") as system:
        with system.client() as client:
            assert client.sparql("ASK { ?s ?p ?o }").verdict
            client.add("Cup", "cup1", at=(1.0, 2.0, 0.0))
        status, line = up(data)
        assert status == 1
        assert f"semmap down --data '{data}'" in line
        settings = data / SETTINGS
        settings.write_text(settings.read_text().replace("{", '{"colour": "red", ', 1))
        status, line = down("--data", tmp_path / "other")
        assert status == 3
        assert f"{data} ({system.endpoint})" in line
        pid = system.pid("kb_node")
        os.kill(pid, signal.SIGSTOP)
        said: list[str] = []
        # in this process, because the watchdog would kill the node while another one starts on a busy machine
        stopping = threading.Thread(
            target=lambda: said.append(system.cli("down", "--connect", system.endpoint))
        )
        stopping.start()
        time.sleep(SLOW_S)
        os.kill(pid, signal.SIGCONT)
        stopping.join(PATIENCE_S)
        assert said == ["stopped\n"]
        assert system.process.wait(timeout=PATIENCE_S) == 0
        until(lambda: system.said[-1] == "stopped\n", "its last log line")
        assert not any("does not answer" in line for line in system.said)
    assert down("--connect", system.endpoint)[0] == 3
    assert down("--data", data)[0] == 3
    with closing(sqlite3.connect(data / JOURNAL)) as journal:
        ((checkpoint, last),) = journal.execute(
            "SELECT (SELECT max(seq) FROM checkpoints), (SELECT max(seq) FROM commits)"
        )
    assert checkpoint == last >= 2
