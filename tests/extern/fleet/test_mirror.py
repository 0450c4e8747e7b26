"""Robots mirrored into a real SPARQL server, which is killed, as the mirror is, while commits stream in."""

from __future__ import annotations

import contextlib
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import threading
import time
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path

import pytest

from semmap.nodes.extern.client import connect
from semmap.nodes.extern.fleet import mirror_config, query
from semmap.nodes.extern.fleet.mirror import Mirror
from semmap.nodes.extern.fleet.server import TIMEOUT_S
from semmap.nodes.kb_node.storage.seed import seed
from semmap.ontology import HOUSEHOLD_TTL
from semmap.schemas import errors
from tests.conftest import PATIENCE_S, until
from tests.extern.fleet.sparql_servers import oxigraph, spelled, virtuoso

SEMMAP = Path(sys.executable).with_name("semmap")
CUPS = "SELECT ?robot ?cup { GRAPH ?robot { ?cup a dm:Cup } } ORDER BY ?robot ?cup"


@pytest.fixture
def server(tmp_path):
    with oxigraph(tmp_path / "oxigraph") as server:
        yield server


@pytest.fixture(params=["oxigraph", "virtuoso"])
def any_server(request, tmp_path):
    if request.param == "virtuoso" and not (shutil.which("virtuoso-t") and shutil.which("isql-vt")):
        pytest.skip("Virtuoso is not installed (Debian: virtuoso-opensource)")
    start = {"oxigraph": oxigraph, "virtuoso": virtuoso}[request.param]
    with start(tmp_path / "server") as server:
        yield server


@pytest.fixture
def arm1(two_robots):
    with connect(two_robots[0].endpoint, namespace="arm1") as client:
        yield client


@contextlib.contextmanager
def mirroring_to(server, where, **options):
    """A mirror at work, on a thread, and what it tells."""
    told = []
    mirror = Mirror(mirror_config.config(server.update_url, where=where, **options), told.append)
    thread = threading.Thread(target=mirror.run)
    thread.start()
    try:
        yield mirror, told
    finally:
        mirror.stop()
        thread.join(timeout=PATIENCE_S)
    assert not thread.is_alive()


def once(server, where, **options):
    """Catch up with all robots."""
    told = []
    Mirror(mirror_config.config(server.update_url, where=where, **options), told.append).run(once=True)
    return told


LITTLE = 10_000
"""Characters of an update."""
STILL_S = PATIENCE_S + 2 * TIMEOUT_S
"""A copy that has not gone on for so long never will: a server that does not answer is asked again before."""


def assert_same(server, client, robot):
    """The robot's graph is its export, at the same commit, as soon as the copy has caught up.

    It may take its time as long as it goes on.
    """
    copied, until_s = None, time.monotonic() + STILL_S
    while (now := _robot_state(server, robot)) != client.status().commit:
        if now != copied:
            copied, until_s = now, time.monotonic() + STILL_S
        assert time.monotonic() < until_s, f"the copy of {robot} stands still at commit {copied}"
        time.sleep(0.1)
    document = client.export("ntriples")
    assert document.seq == client.status().commit
    assert server.graph(robot) == spelled(document.content)


def _robot_state(server, robot):
    """The commit of a robot's copy; None where the server does not say."""
    with contextlib.suppress(errors.NoAnswer):
        return query.sparql("ASK {}", server.query_url, robot, reachable=False).robots[0].commit
    return None


def test_a_graph_is_the_robots_export_and_goes_with_it(any_server, two_robots, arm1):
    server, where = any_server, two_robots[0].endpoint
    with mirroring_to(server, where) as (mirror, told):
        assert_same(server, arm1, "arm1")
        arm1.add("Cup", "cup5", at=(1, 1, 0.7), ref='a "cup"')
        assert_same(server, arm1, "arm1")
        arm1.update("cup5", at=(2, 1, 0.7))
        arm1.remove("cup5")
        assert_same(server, arm1, "arm1")
        assert mirror.commits >= 3
    assert any("arm1: copied at commit" in text for text in told)


def test_a_restarted_mirror_resumes(server, two_robots, arm1):
    where = two_robots[0].endpoint
    assert sum("copied" in text for text in once(server, where)) == 2
    arm1.add("Cup", "cup6", at=(1, 1, 0.7))
    arm1.remove("cup6")
    told = once(server, where)
    assert not any("copied" in text for text in told), told
    assert_same(server, arm1, "arm1")


def test_a_robot_that_is_far_ahead_is_copied_again_in_the_same_epoch(server, two_robots, arm1):
    where = two_robots[0].endpoint
    once(server, where)
    for _ in range(3):
        arm1.add("Cup", "cup7", at=(1, 1, 0.7))
        arm1.remove("cup7")
    from msgspec import structs

    config = structs.replace(mirror_config.config(server.update_url, where=where, robots="arm1"), far=3)
    told = []
    Mirror(config, told.append).run(once=True)
    assert "6 commits ahead" in told[0]
    assert_same(server, arm1, "arm1")
    assert query.sparql("ASK {}", server.query_url, "arm1", reachable=False).robots[0].epoch == 1


def test_answers_across_robots_have_each_ones_commit_beside_them(server, two_robots, arm1):
    where = two_robots[0].endpoint
    once(server, where)
    arm1.add("Cup", "cup8", at=(1, 1, 0.7))
    try:
        said = two_robots[0].cli("fleet", "sparql", CUPS, "--sparql-query", server.query_url)
    finally:
        arm1.remove("cup8")
    assert "<urn:semmap:robot:arm1>  :cup1" in said
    assert f"  arm1: commit {arm1.status().commit - 2}, 1 behind\n" in said
    assert ", up to date" in said.partition("  arm2:")[2]
    answer = query.sparql("ASK { ?s a dm:Cup }", server.query_url, "arm2", where=where)
    assert [(answer.result.verdict, one.robot, one.behind) for one in answer.robots] == [(False, "arm2", 0)]


def test_json_of_an_answer(server, two_robots):
    once(server, two_robots[0].endpoint)
    words = ("fleet", "sparql", CUPS, "--sparql-query", server.query_url, "--format", "json")
    said = json.loads(two_robots[0].cli(*words))
    assert [one["robot"] for one in said["robots"]] == ["arm1", "arm2"]
    assert all(len(one["digest"]) == 32 and one["epoch"] == 1 for one in said["robots"])


def test_poses_are_asked_for_in_the_fleets_frame(server, two_robots):
    once(server, two_robots[0].endpoint, frames=["arm1=10,0,0,1.5707963267948966"])
    select = """SELECT ?x ?y ?z {
        ?robot fleet:name "arm1" ; fleet:poses ?poses .
        GRAPH ?poses { :cup1 fleet:x ?x ; fleet:y ?y ; fleet:z ?z } }"""
    (row,) = query.sparql(select, server.query_url, reachable=False).result.rows
    assert [float(term.split('"')[1]) for term in row] == pytest.approx([8.0, 1.0, 0.7])


def test_a_server_that_takes_little_at_a_time_gets_less(server, two_robots, arm1, monkeypatch):
    """Virtuoso, for one; the copy stood still for good when it was some hundred commits behind."""
    once(server, two_robots[0].endpoint)
    names = [f"plate{number}" for number in range(30)]
    for number, name in enumerate(names):
        arm1.add("Plate", name, at=(number, 5.0, 0.7))
    mirror, refused = Mirror(mirror_config.config(server.update_url, where=two_robots[0].endpoint)), []
    update = mirror._writer.update

    def take_little(operations):
        if (size := sum(map(len, operations))) > LITTLE:
            refused.append(size)
            raise errors.BadRequest("too much at once")
        update(operations)

    monkeypatch.setattr(mirror._writer, "update", take_little)
    mirror.run(once=True)
    assert refused
    assert_same(server, arm1, "arm1")
    arm1.remove(*names)


def test_exactly_once_though_mirror_and_server_are_killed(any_server, two_robots, arm1, tmp_path):
    """Kill -9 of the one and of the other in turn, while a robot's map changes all the time."""
    server, where = any_server, two_robots[0].endpoint
    command = [SEMMAP, "fleet", "mirror", "--sparql-update", server.update_url, "--connect", where]
    done = threading.Event()
    dice = random.Random(16)

    def stream():
        with connect(where, namespace="arm1") as client:
            n = 0
            while not done.is_set():
                n += 1
                client.add("Cup", f"c{n}", at=(n % 7, n % 5, 0.7))
                if n > 5:
                    client.remove(f"c{n - 5}")
            client.remove(*(f"c{k}" for k in range(n - 4, n + 1)))

    def goes_on():
        before = _robot_state(server, "arm1")
        until(lambda: _robot_state(server, "arm1") not in (before, None), "the copy goes on")
        time.sleep(dice.uniform(0.0, 0.3))  # the kill comes in the middle of anything

    streaming = threading.Thread(target=stream)
    streaming.start()
    try:
        with (tmp_path / "told").open("w") as told:
            for kill in range(6):
                mirror = subprocess.Popen(command, stdout=told, stderr=told, env=os.environ)
                try:
                    goes_on()
                    if kill % 2:
                        server.kill()
                        time.sleep(dice.uniform(0.0, 0.5))
                        server.start()
                        goes_on()
                finally:
                    mirror.send_signal(signal.SIGKILL)
                    mirror.wait()
    finally:
        done.set()
        streaming.join(timeout=PATIENCE_S)
    assert not streaming.is_alive()
    with mirroring_to(server, where):
        assert_same(server, arm1, "arm1")
    copied = [line for line in (tmp_path / "told").read_text().splitlines() if "arm1: copied" in line]
    # And otherwise it went on, commit by commit, unless it was a thousand behind.
    why = ("first copy", "commits ahead", "is incomplete")
    assert all(any(reason in line for reason in why) for line in copied), copied
    assert sum("first copy" in line for line in copied) <= 1, copied


def test_a_map_that_is_started_again_is_another_epoch(server, tmp_path):
    from tests.conftest import free_endpoint, running
    from tests.extern.fleet.conftest import BARE

    endpoint = free_endpoint()
    with running(tmp_path / "d", *BARE, "--namespace", "lift1", endpoint=endpoint) as lift1:
        lift1.cli("add", "Cup", "cup1", "--at", "1", "1", "0.7")
        once(server, endpoint)
        with mirroring_to(server, endpoint) as (_, told), lift1.client() as client:
            seed(tmp_path / "fresh", HOUSEHOLD_TTL, None)
            lift1.open_map(tmp_path / "fresh")
            until(
                lambda: any("started a new map" in text for text in told),
                "it is seen that the map is another one",
            )
            client.add("Bowl", "bowl1", at=(1, 1, 0.7))
            assert_same(server, client, "lift1")
    (robot,) = query.sparql("ASK {}", server.query_url, reachable=False).robots
    assert robot.epoch == 2
    ended = "SELECT ?commit { ?epoch a fleet:Epoch ; fleet:number 1 ; fleet:commit ?commit }"
    assert len(query.sparql(ended, server.query_url, reachable=False).result.rows) == 1


def test_a_server_that_is_down_is_waited_for(server, two_robots, arm1):
    server.kill()
    with mirroring_to(server, two_robots[0].endpoint, robots="arm1") as (mirror, told):
        until(lambda: mirror.trouble, "it is said")
        assert (
            f"no response from the SPARQL server at {server.query_url}: Connection refused; trying again"
            in told
        )
        server.start()
        assert_same(server, arm1, "arm1")
        assert "the SPARQL server is available again" in told


class Moody(BaseHTTPRequestHandler):
    """Answers everything with one status."""

    status = 500

    def do_POST(self):
        self.rfile.read(int(self.headers["Content-Length"]))
        self.send_response(self.status)
        self.send_header("Content-Length", "6")
        self.end_headers()
        self.wfile.write(b"<oops>")

    def log_message(self, *_):
        pass


@pytest.mark.parametrize(
    ("status", "said"),
    [
        (500, "server error (500): <oops>"),
        (401, "access denied (401); add user and password"),
        (404, "there is no SPARQL endpoint at"),
        (200, "does not return SPARQL results"),
    ],
)
def test_a_server_that_rejects_is_reported_in_a_sentence(two_robots, status, said):
    http = HTTPServer(("127.0.0.1", 0), type("It", (Moody,), {"status": status}))
    threading.Thread(target=http.serve_forever, daemon=True).start()
    url = f"http://127.0.0.1:{http.server_port}/update"
    try:
        with pytest.raises(errors.SemmapError) as refused:
            Mirror(mirror_config.config(url, where=two_robots[0].endpoint)).run(once=True)
        assert said in str(refused.value)
        assert said in two_robots[0].cli(
            "fleet",
            "sparql",
            "ASK {}",
            "--sparql-query",
            url,
            status=refused.value.exit_status if status != 401 and status != 404 else 1,
        )
    finally:
        http.shutdown()
        http.server_close()


def test_a_server_that_is_slow_is_not_waited_for_without_end(two_robots):
    import socket

    from msgspec import structs

    with socket.socket() as deaf:
        deaf.bind(("127.0.0.1", 0))
        deaf.listen()
        url = f"http://127.0.0.1:{deaf.getsockname()[1]}/update"
        config = structs.replace(mirror_config.config(url, where=two_robots[0].endpoint), timeout_s=0.3)
        with pytest.raises(errors.NoAnswer, match=r"within 0\.3 s"):
            Mirror(config).run(once=True)


@pytest.mark.parametrize("url", ["ftp://x/update", "localhost:7878", "http://", "http://x:99999/update"])
def test_an_invalid_url(two_robots, url):
    said = two_robots[0].cli("fleet", "mirror", "--sparql-update", url, status=2)
    assert "is not the URL of a SPARQL server" in said


@pytest.mark.parametrize("frame", ["arm1", "arm1=1,2,3", "arm1=1,2,3,nan", "=1,2,3,4", "a/b=1,2,3,4"])
def test_an_invalid_frame(two_robots, frame):
    words = ("fleet", "mirror", "--sparql-update", "http://127.0.0.1:1/update", "--frame", frame)
    assert frame.split("=")[0] in two_robots[0].cli(*words, status=2)


def test_no_robot_has_been_mirrored(server, two_robots):
    words = ("fleet", "sparql", "ASK {}", "--sparql-query", server.query_url)
    assert "no mirrored robot at" in two_robots[0].cli(*words, status=3)
