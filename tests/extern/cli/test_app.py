"""Bad input through the command line: one clear line, its exit status, nothing changed, all alive."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading

import numpy as np
import pytest

from tests.conftest import until


@pytest.fixture(scope="module")
def system(empty_scene):
    with empty_scene.client() as client:
        client.add("Chair", "chair1", at=(1.0, 1.0, 0.0), ref="chair", wait=True)
    return empty_scene


@pytest.fixture
def files(tmp_path):
    base = "http://www.semanticweb.org/ontologies/2016/1/"
    chair = f"<{base}semantic_mapping_1#chair2>"
    dm = f"{base}semantic_mapping_domain_model#"
    (tmp_path / "truncated.owl").write_text(
        '<?xml version="1.0"?><rdf:RDF xmlns:rdf="http://www.w3.org/1999/02/'
    )
    (tmp_path / "truncated.ttl").write_text(f"{chair} a <{dm}Ch")
    (tmp_path / "inconsistent.ttl").write_text(f"{chair} a <{dm}Chair>, <{dm}Kitchen> .")
    (tmp_path / "unknown.ttl").write_text(f"{chair} a <{dm}Chiar> .")
    (tmp_path / "empty.ttl").write_text("")
    (tmp_path / "bytes.bin").write_bytes(bytes(range(256)))
    (tmp_path / "tbox.ttl").write_text(f"<{dm}Drone> a <http://www.w3.org/2002/07/owl#Class> .")
    (tmp_path / "other.json").write_text('{"chairs": 3}')
    return tmp_path


_REFERENCE = "SELECT ?text { :cup4 dm:hasPreferredReference/dm:lexicalReference ?text }"

BAD = [
    (("add", "Chiar"), 2, "did you mean Chair"),
    (("add", "Color"), 2, "is not a spatial class"),
    (("add", "Chair", "chair1"), 1, "taken"),
    (("add", "Chair", "my chair"), 2, "valid name"),
    (("add", "Chair", "1chair"), 2, "valid name"),
    (("add", "Chair", "a/b"), 2, "valid name"),
    (("add", "Chair", "c", "--at", "nan", "0", "0"), 2, "at"),
    (("add", "Chair", "c", "--at", "inf", "0", "0"), 2, "at"),
    (("add", "Chair", "c", "--at", "1e9", "0", "0"), 2, "at"),
    (("add", "Chair", "c", "--at", "0", "0"), 2, "at"),
    (("add", "Chair", "c", "--at", "a", "b", "c"), 2, "at"),
    (("add", "Chair", "c", "--orientation", "1", "1", "0", "0"), 2, "quaternion"),
    (("add", "Chair", "c", "--size", "1", "-1", "1"), 2, "size"),
    (("add", "Chair", "c", "--size", "0", "1", "1"), 2, "size"),
    (("add", "Chair", "c", "--ref", ""), 2, "ref"),
    (("add", "Chair", "c", "--colour", "red"), 2, "colour"),
    (("add",), 2, "CLASS"),
    (("update", "chair7", "--ref", "x"), 1, "did you mean chair1"),
    (("update", "chair1", "--class", "Chiar"), 2, "did you mean Chair"),
    (("update", "chair1", "--class", "Color"), 2, "is not a spatial class"),
    (("remove", "chair7"), 1, "no entity is named"),
    (("remove", "chair1", "chair7"), 1, "no entity is named"),
    (("get", "chair7"), 1, "did you mean chair or chair1"),
    (("move", "chair7", "--at", "0", "0", "0"), 1, "no entity is named"),
    (("list", "--class", "Chiar"), 2, "did you mean Chair"),
    (("list", "--format", "xml"), 2, "xml"),
    (("infer", "chair7"), 1, "no entity has the name, label or class"),
    (("explain", "chair1", "type", "Kitchen"), 1, "does not hold"),
    (("explain", "chair1", "hasColour", "red"), 2, "did you mean hasColor"),
    (("lst",), 2, "did you mean list"),
    (("node",), 2, "choose from: kb_node, coordinator"),
    (("load", "/dev/zero"), 2, "/dev/zero is larger than 1024 MiB"),
    (("load", "nowhere.owl"), 2, "there is no file nowhere.owl"),
    (("load", "/"), 2, "is a directory"),
    (("export", "/nowhere/map.owl"), 2, "cannot be written"),
    (("export", "map.foo"), 2, "map.foo: unknown suffix"),
    (("undo", "9" * 30), 2, "commit"),
    (("run", "nowhere.txt"), 2, "there is no file"),
    (("watch", "semmap//x"), 2, "is not a valid key expression"),
    (("watch", "semmap/**", "--sparql", "SELECT ?s {}"), 2, "exclude each other"),
    (("watch", "--on", "table1", "--sparql", "SELECT ?s {}"), 2, "exclude each other"),
    (("picture", "."), 2, "scene.png"),
    (("picture", "scene.jpg"), 2, "scene.png"),
    (("add", "sedla"), 2, "did you mean Chair ('sedia')"),
]


@pytest.fixture(scope="module")
def client(system):
    with system.client() as client:
        yield client


@pytest.fixture
def unchanged(client):
    """Bad input changes nothing and harms no node."""

    def state():
        now = client.status()
        return now.commit, [(node.node, node.pid, node.last_error) for node in now.nodes]

    before = state()
    yield
    assert state() == before
    until(lambda: {node.state for node in client.status().nodes} == {"ready"}, "all nodes are ready")


@pytest.mark.parametrize(("words", "status", "said"), BAD, ids=lambda value: str(value)[:40])
@pytest.mark.usefixtures("unchanged")
def test_bad_words(system, words, status, said):
    assert said in system.cli(*words, status=status)


@pytest.mark.parametrize(
    ("file", "status", "said"),
    [
        ("truncated.owl", 2, "not valid RDF/XML"),
        ("truncated.ttl", 2, "not valid Turtle"),
        ("inconsistent.ttl", 1, "chair2"),
        ("unknown.ttl", 2, "unknown class 'Chiar' (of chair2"),
        ("empty.ttl", 2, "empty"),
        ("bytes.bin", 2, "not UTF-8 text"),
        ("other.json", 2, "neither a scene"),
        ("tbox.ttl", 2, "to load a TBox use --tbox"),
    ],
)
@pytest.mark.usefixtures("unchanged")
def test_bad_files(system, files, file, status, said):
    assert said in system.cli("load", files / file, status=status)


def test_a_file_of_requests_reports_each(system, tmp_path):
    requests = tmp_path / "requests.txt"
    requests.write_text(
        '# a comment\nadd Cup cup1 --at 3 3 0 --ref "a cup"\n\n'
        '{"verb": "update", "name": "cup1", "alt": ["mug"]}\nget cup1\nremove cup1\n'
    )
    said = system.cli("run", requests)
    assert "2: add Cup cup1" in said
    assert "added Cup cup1 at (3, 3, 0)" in said
    assert "mug" in said
    assert "removed 1: cup1" in said


def test_a_file_of_requests_stops_at_the_first_that_fails_unless_told_otherwise(system, tmp_path):
    requests = tmp_path / "requests.txt"
    requests.write_text("add Chiar\nadd Cup cup2\n")
    assert "cup2" not in system.cli("run", requests, status=2)
    requests.write_text('get chair7\nget chair1\nremove\n{"verb": "fly"}\n')
    with pytest.raises(AssertionError):  # more than one line of errors: one a request, and the sum
        system.cli("run", "--keep-going", requests, status=1)


@pytest.mark.parametrize("line", ["up", "down", "watch", "run requests.txt", "semmap node kb_node"])
def test_a_file_of_requests_starts_and_stops_nothing(system, tmp_path, line):
    requests = tmp_path / "requests.txt"
    requests.write_text(f"get chair1\n{line}\n")
    assert "semmap: line 2: '" in system.cli("run", requests, status=2)


def test_what_a_reference_holds_is_shown_as_it_is(system):
    system.cli("add", "Cup", "cup4", "--at", "5", "5", "0", "--ref", "[/bold] [m]\n\x1b[31m")
    for said in (system.cli("list"), system.cli("get", "cup4"), system.cli("sparql", _REFERENCE)):
        assert r"[/bold] [m]\n\x1b[31m" in said.replace(r"\u001B", r"\x1b")
    assert "size [m]" in system.cli("list")
    system.cli("remove", "cup4")


def test_wide_rows_lose_no_column(system):
    said = system.cli("sparql", 'SELECT ("left" AS ?x) (1.5e300 AS ?y) ("right" AS ?z) {}')
    assert "left" in said
    assert "right" in said


def test_an_export_follows_links_and_writes_into_pipes(system, tmp_path):
    target, link, pipe = (tmp_path / name for name in ("target.ttl", "link.ttl", "pipe.ttl"))
    link.symlink_to(target)
    system.cli("export", link)
    assert link.is_symlink()
    assert "chair1" in target.read_text()
    os.mkfifo(pipe)
    read: list[str] = []
    reading = threading.Thread(target=lambda: read.append(pipe.read_text()))
    reading.start()
    system.cli("export", pipe)
    reading.join(timeout=10)
    assert "chair1" in read[0]
    assert pipe.is_fifo()


def test_an_export_of_the_past_has_what_was_there_then(system, tmp_path):
    system.cli("add", "Cup", "cup_exported", "--at", "5", "5", "0")
    assert "(commit 1)" in system.cli("export", tmp_path / "then.ttl", "--as-of", "1")
    system.cli("export", tmp_path / "now.ttl")
    assert "cup_exported" not in (tmp_path / "then.ttl").read_text()
    assert "cup_exported" in (tmp_path / "now.ttl").read_text()
    system.cli("remove", "cup_exported")


def test_numbers_may_be_numpys(system):
    with system.client() as client:
        client.add(
            "Cup", "cup5", at=np.array([5.0, 5.0, 0.0]), yaw=np.float32(0.5), size=(np.float64(0.1),) * 3
        )
        assert client.get("cup5").pose.position_m == (5.0, 5.0, 0.0)
        client.remove("cup5")


def test_watch_shows_what_happens(system):
    seen: list[str] = []
    with system.spawned("watch", "semmap/jena/entity/Cup/*") as watching, system.client() as client:
        reading = threading.Thread(target=lambda: seen.extend(watching.stdout), daemon=True)
        reading.start()

        def announced():
            client.add("Cup", "cup3", at=(3.0, 3.0, 0.0))
            client.remove("cup3")
            text = "".join(seen)
            return '"preferred_reference"' in text and "cup3  gone" in text

        until(announced, "watch shows a cup coming and going")
        watching.send_signal(signal.SIGINT)
        reading.join(timeout=10)  # before its end of the pipe is closed
    assert watching.wait(timeout=10) == 130


def test_without_a_system_there_is_no_response(system, monkeypatch):
    system_elsewhere = "tcp/127.0.0.1:9"
    said = system.cli("list", "--connect", system_elsewhere, status=3)
    assert "no response from tcp/127.0.0.1:9" in said


def test_a_query_command_imports_nothing_heavy():
    heavy = {"mujoco", "numpy", "open3d", "owlrl", "rdflib", "rerun", "scipy", "supervisor", "trimesh"}
    code = (
        "import sys; from semmap.nodes.extern.cli.all_commands import app; app.get_command(None, 'sparql');"
        " print(*sys.modules)"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert "semmap.nodes.extern.cli.commands.query" in run.stdout.split()
    assert "semmap.nodes.extern.cli.commands.edit" not in run.stdout.split()
    assert not heavy & set(run.stdout.split())
