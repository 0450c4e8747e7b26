"""More entities than are published one by one: load, subscribe, list, query and restart."""

from __future__ import annotations

import json
import os
import shutil
import signal
import sqlite3
import subprocess
from contextlib import closing

import pytest

from benchmarks.kb import big_files
from semmap.ontology import vocabulary as v
from semmap.schemas.commits import MANY_ENTITIES
from tests.conftest import running, until

COUNT = MANY_ENTITIES + 500
UP = ("--abox", "none", "--no-sim", "--no-record")
COUNTED = f"SELECT (COUNT(?c) AS ?n) {{ ?c a <{v.bare(v.dm('Cup'))}> }}"


@pytest.fixture
def system(empty_map):
    """The shared system without a simulator, with an empty map at commit 1 for each test."""
    empty_map.begin_anew("none")
    return empty_map


def scene(file, count=COUNT):
    entities = [
        {"class": "Fridge" if i % 100 == 0 else "Cup", "name": f"thing{i}", "at": [i % 100, i // 100, 0]}
        for i in range(count)
    ]
    file.write_text(json.dumps({"entities": entities}))
    return file


def counted(client):
    ((found,),) = client.sparql(COUNTED, timeout=60.0).rows
    return int(v.lexical(found))


@pytest.mark.long
def test_an_abridged_commit_reaches_all_subscribers(tmp_path):
    with running(tmp_path / "data", *UP) as system, system.client() as client:
        with client.commits(timeout=60.0) as commits:
            loaded = client.load(scene(tmp_path / "many.json"))
            commit = next(commits)
        assert len(loaded.names) == COUNT
        assert (commit.seq, commit.changed, commit.inserted) == (loaded.commit, (), ())
        assert commit.abridged.changed == COUNT
        assert client.get(f"thing{COUNT - 1}").class_ == "Cup"
        assert len(client.list("Fridge")) == COUNT // 100
        assert client.status().entities == COUNT
        assert counted(client) == COUNT - COUNT // 100
        client.remove("thing1")
        assert counted(client) == COUNT - COUNT // 100 - 1
        assert client.status().entities == COUNT - 1
        undone = client.undo(loaded.commit + 1)
        assert undone.names == ("thing1",)
    with running(tmp_path / "data", *UP) as system, system.client() as client:
        assert client.status().entities == COUNT
        assert counted(client) == COUNT - COUNT // 100


def checkpointed(data, copy):
    """The commit of the newest checkpoint, as a copy of the journal tells, which is locked itself."""
    copy.mkdir(exist_ok=True)
    for name in ("journal.sqlite", "journal.sqlite-wal"):
        shutil.copyfile(data / name, copy / name)
    with closing(sqlite3.connect(copy / "journal.sqlite")) as db:
        return db.execute("SELECT max(seq) FROM checkpoints").fetchone()[0]


@pytest.mark.long
def test_a_checkpoint_follows_a_very_large_commit_and_a_kill_loses_nothing(system, tmp_path):
    data, count = system.data, 8000
    big_files.write_turtle(tmp_path / "many.ttl", count)
    with system.client() as client:
        loaded = client.load(tmp_path / "many.ttl")
        client.add("Cup", "later", at=(0, 0, 0))
        until(lambda: checkpointed(data, tmp_path / "copy") >= loaded.commit, "a checkpoint is written")
        client.remove("thing7")
        pid = system.pid("kb_node")
        os.kill(pid, signal.SIGKILL)
        until(lambda: system.pid("kb_node") not in (0, pid), "it is back")
        assert {entity.name for entity in client.list()} == {
            "later",
            *(f"thing{i}" for i in range(count) if i != 7),
        }
        assert client.check().consistent


@pytest.mark.long
@pytest.mark.parametrize("kind", ["scene", "turtle"])
def test_a_load_in_parts(system, tmp_path, kind):
    file = scene(tmp_path / "many.json")
    if kind == "turtle":
        file = tmp_path / "many.ttl"
        stars = (
            f'<{v.ABOX}thing{i}> a <{v.TBOX}Cup> ; <{v.RDFS}label> "cup {i}" .\n' for i in range(6 * COUNT)
        )
        file.write_text("".join(stars))
    said = system.cli("load", file, "--parts")
    with system.client() as client:
        newest, *_ = reversed(client.history())
        assert ", part 2 of 2" in newest.reason
        assert client.status().commit == newest.seq
        assert client.get(f"thing{COUNT - 1}").provenance.commit <= newest.seq
        until(lambda: client.status().entities == (COUNT if kind == "scene" else 6 * COUNT), "all of it")
    assert f"loaded {COUNT if kind == 'scene' else 6 * COUNT} entities" in said


def test_a_part_that_is_refused_says_what_stays(system, tmp_path):
    file = scene(tmp_path / "many.json")
    document = json.loads(file.read_text())
    document["entities"][-1]["class"] = "Kitchen"
    document["entities"][-1]["affords"] = ["containing"]
    document["entities"].append({"class": "Cup", "name": "thing0"})
    file.write_text(json.dumps(document))
    assert "the name 'thing0' is given twice" in system.cli("load", file, "--parts", status=1)
    with system.client() as client:
        assert client.status().entities == 0


@pytest.mark.long
def test_a_hundred_thousand(tmp_path):
    """The store of SPARQL is on disk, and there at the next start; nodes live on meanwhile."""
    count = 100_000
    file = scene(tmp_path / "many.json", count)
    data = tmp_path / "data"
    with running(data, *UP) as system:
        with system.client() as client:
            pids = {node.node: node.pid for node in client.status().nodes}
        with system.spawned("load", str(file), stderr=subprocess.PIPE) as loading:
            said, told = loading.communicate()
        assert loading.returncode == 0, told
        assert f"loaded {count} entities" in said
        assert "100,000 entities to check and write" in told
        with system.client() as client:
            assert counted(client) == count - count // 100
            assert {node.node: node.pid for node in client.status().nodes} == pids
        (store,) = [path for path in (data / "sparql").iterdir() if path.name[0].isdigit()]
    with running(data, *UP) as system, system.client() as client:
        client.add("Cup", "one_more", at=(0, 0, 0))
        assert counted(client) == count - count // 100 + 1
        assert store.exists()
