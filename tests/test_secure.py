"""A whole system with `--secure`: permissions, provenance, and the router as the only listener."""

from __future__ import annotations

import json
import os
import signal
import stat
import subprocess
import time

import psutil
import pytest

from semmap.nodes import bus
from semmap.nodes.extern import connection
from semmap.nodes.extern.client import connect
from semmap.nodes.identity import Identity, authority
from semmap.nodes.supervisor.ports import free_endpoint
from semmap.schemas import codec, commands, errors, keys
from semmap.schemas.commits import Commit
from semmap.schemas.health import Health
from semmap.schemas.replies import Changed
from tests.conftest import running, until
from tests.depth import tries

NAMES = {"vera": "viewer", "bob": "operator", "eye": "perception", "spot": "robot", "root": "admin"}
COUNT = tries(135)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("secure") / "K"
    authority.init(folder)
    for name, role in NAMES.items():
        authority.add(folder, name, role)
    return folder


@pytest.fixture(scope="module")
def system(tmp_path_factory, folder):
    data = tmp_path_factory.mktemp("secure") / "d"
    with running(data, "--secure", folder) as system:
        yield system


@pytest.fixture
def as_(system, folder):
    """Of a name, `client(...)` of it."""
    return lambda name, **options: connect(system.endpoint, identity=str(folder / name), **options)


@pytest.fixture
def raw(system, folder):
    """Of a name, a session of it that checks nothing by itself."""

    def opened(name):
        identity = Identity.read(folder / name)
        return bus.open_session(bus.Network(connect=(bus.to_tls(system.endpoint),), identity=identity))

    return opened


def test_a_stranger_sees_nothing(system, monkeypatch):
    assert "--identity DIR/NAME" in system.cli("status", "--connect", bus.to_tls(system.endpoint), status=3)
    monkeypatch.setattr(connection, "_START_S", 1.0)  # the system has started
    system.cli("status", status=3)  # without TLS


def test_who_comes_with_a_certificate_of_another_authority_is_turned_away_at_once(system, tmp_path):
    authority.init(tmp_path / "L")
    authority.add(tmp_path / "L", "bob", "operator")
    said = system.cli("status", "--identity", tmp_path / "L" / "bob", status=3)
    assert "rejects the certificate of bob" in said  # not: "has not started yet", as after waiting


def test_queries_are_answered_and_forbidden_changes_are_rejected(system, folder):
    assert "fridge1" in system.cli("get", "fridge1", "--identity", folder / "vera")
    assert "true" in system.cli("sparql", "ASK {?s ?p ?o}", "--identity", folder / "vera")
    for words in (
        ("add", "Cup", "cup9"),
        ("remove", "fridge1"),
        ("undo",),
        ("move", "chair1", "--at", "1", "1", "0"),
    ):
        for name in ("vera", "spot"):
            said = system.cli(*words, "--identity", folder / name, status=1)
            role = f"role '{NAMES[name]}' of your certificate"
            assert said.startswith(f"semmap: {role} may not use '{words[0]}'; ")


def test_a_change_is_signed_with_the_name_that_the_certificate_proves(as_, system, folder):
    with as_("bob", agent="alice") as bob, as_("vera") as vera, vera.commits(timeout=30) as commits:
        made = bob.add("Cup", "signed1", at=(1.0, 2.0, 0.75), reason="signed")
        commit = next(c for c in commits if c.seq == made.commit)
        assert (commit.agent, commit.source, commit.authenticated) == ("bob", "operator", True)
        assert vera.get("signed1").pose_provenance.agent == "bob"
        (first,) = vera.history(until=1)
        assert not first.authenticated
    said = system.cli("history", "signed1", "--identity", folder / "vera")
    assert "operator/@bob" in said.replace("\n", "")
    logged = json.loads(system.cli("history", "signed1", "--format", "json", "--identity", folder / "vera"))
    assert (logged[0]["agent"], logged[0]["authenticated"]) == ("bob", True)


def test_perception_speaks_as_perception_only(as_, raw):
    with as_("eye") as eye:
        made = eye.add("Cup", "seen1", at=(1.5, 2.0, 0.75))
        assert eye.get("seen1").pose_provenance.source == "perception"
        assert made.commit is not None
        with pytest.raises(errors.Refused, match="only an operator may"):
            eye.remove("fridge1")
    with (
        as_("eye", source="operator") as eye,
        pytest.raises(errors.Refused, match="may not use the source operator"),
    ):
        eye.remove("fridge1")
    forged = commands.Remove(names=("fridge1",), source="operator")
    with raw("eye") as session, pytest.raises(errors.Refused, match="may not use the source operator"):
        bus.ask(session, keys.commands_as("eye"), "remove", forged, Changed)


def test_the_coordinator_refuses_what_a_client_did_not(raw):
    with raw("vera") as session, pytest.raises(errors.Refused, match="may not use 'clear'"):
        bus.ask(session, keys.commands_as("vera"), "clear", commands.Clear(), Changed)
    tbox = commands.Load(content=b"", tbox=True)
    with raw("bob") as session, pytest.raises(errors.Refused, match="may not use 'load --tbox'"):
        bus.ask(session, keys.commands_as("bob"), "load", tbox, Changed)
    with raw("root") as session, pytest.raises(errors.SemmapError) as caught:  # admitted, and no TBox
        bus.ask(session, keys.commands_as("root"), "load", tbox, Changed)
    assert "certificate" not in caught.value.text


def test_a_client_cannot_use_the_identity_of_another(raw):
    add = commands.Add(class_="Cup", name="forged1", at=(0.0, 0.0, 1.0))
    with raw("root") as session:
        for prefix in (
            keys.CMD,
            keys.commands_as("bob"),
            keys.commands_as("coordinator"),
            keys.commands_as(),
        ):
            with pytest.raises(errors.NoAnswer):
                bus.ask(session, prefix, "add", add, Changed, patience_s=0.0)
        for key in (f"{keys.CMD}/add", f"{keys.commands_as('root')}/add", keys.CMD):
            session.put(key, codec.encode(add))
        wild = list(session.get(f"{keys.commands_as('root')}/*", payload=codec.encode(add)))
        assert all(reply.ok is None for reply in wild)
        with pytest.raises(errors.UnknownName):
            bus.ask(session, keys.commands_as("root"), "get", commands.Get(name="forged1"), object)


def test_nothing_of_a_nodes_can_be_forged(raw, as_, system):
    with raw("root") as forger, as_("vera") as vera:
        beats: list[str] = []
        bus.follow(vera.session, keys.HEALTH, lambda _, health: beats.append(health.node))
        before = vera.status().commit
        beat = Health(node="x", pid=1, started_ns=0, stamp_ns=0, state="ready")
        forger.put(keys.health_key("x"), codec.encode(beat))
        forger.put(
            keys.COMMIT.key, codec.encode(Commit(seq=before + 1, stamp_ns=0, id="f", source="operator"))
        )
        forger.declare_queryable(f"{keys.commands_as()}/add", lambda query: query.drop(), complete=True)
        forger.liveliness().declare_token(keys.live_key("coordinator", "9"))
        with as_("bob") as bob:
            made = bob.add("Cup", "cup2", at=(2.0, 2.0, 0.75))
        # A body may have come to rest meanwhile.
        told = vera.history(since=str(before + 1), until=str(made.commit))
        assert [commit.seq for commit in told] == list(range(before + 1, made.commit + 1))
        assert all(commit.changed for commit in told)
        until(lambda: len(beats) > 8, "beats of nodes")
        assert "x" not in beats
        assert system.process.poll() is None


def test_only_the_router_listens(as_):
    with as_("vera") as vera:
        nodes = {node.node: psutil.Process(node.pid) for node in vera.status().nodes}
    assert set(nodes) == {"router", "coordinator", "kb_node", "sim_node", "recorder"}
    listening = {
        node: [c.laddr.port for c in process.net_connections(kind="inet") if c.status == psutil.CONN_LISTEN]
        for name, process in nodes.items()
        for node, process in [(name, process), *((f"{name}'s", child) for child in process.children(True))]
    }
    assert {node for node, ports in listening.items() if ports} == {"router"}
    assert len(listening["router"]) == 1


def test_the_data_is_its_users_alone(system):
    modes = {stat.S_IMODE(p.stat().st_mode) for p in system.data.rglob("*") if p.is_file()}
    folders = {stat.S_IMODE(p.stat().st_mode) for p in (system.data, *system.data.rglob("*")) if p.is_dir()}
    assert (modes, folders) == ({0o600}, {0o700})


def test_a_standing_query_reaches_a_viewer(as_):
    with as_("vera") as vera, vera.watch("SELECT ?c { ?c a dm:Cup }") as standing:
        with as_("bob") as bob:
            bob.add("Cup", "cup3", at=(3.0, 2.0, 0.75))
        news = next(standing.changes(timeout=30))
        assert "cup3" in str(news.appeared)


def test_entities_are_followed_by_class(as_, raw):
    heard: list[str] = []
    with raw("vera") as session:
        session.declare_subscriber(
            keys.entity_key("Cup", "*").replace("%2A", "*"), lambda s: heard.append(str(s.key_expr))
        )
        with as_("bob") as bob:
            for n in range(100):
                bob.add("Cup", f"followed{n}", at=(3.0, 2.0 + n / 10, 0.75))
                if heard:
                    break
        until(lambda: heard, "an entity")


def test_a_killed_router_is_back_and_found_again(as_):
    with as_("vera") as vera:
        pid = next(node.pid for node in vera.status().nodes if node.node == "router")
        os.kill(pid, signal.SIGKILL)

        def another():
            try:
                return [n for n in vera.status().nodes if n.node == "router" and n.pid != pid]
            except errors.NoAnswer:
                return []

        until(another, "another router")
        until(lambda: _answered(vera), "an answer of the map")


def test_only_a_router_that_hangs_is_replaced(as_):
    with as_("vera") as vera:
        before = {node.node: node.pid for node in vera.status().nodes}
        os.kill(before["router"], signal.SIGSTOP)

        def others():
            try:
                pids = {node.node: node.pid for node in vera.status().nodes}
            except errors.NoAnswer:
                return {}
            return pids if pids.get("router", before["router"]) != before["router"] else {}

        after = until(others, "another router")
    assert {node for node in before if before[node] != after[node]} == {"router"}


def test_who_is_revoked_is_shut_out_and_who_is_added_let_in(as_, folder, raw):
    authority.add(folder, "kim", "operator")
    with as_("kim") as kim:
        until(lambda: _answered(kim), "an answer")
        assert kim.add("Cup", "kims1", at=(4.0, 2.0, 0.75)).commit is not None
        authority.revoke(folder, "kim")
        until(lambda: not _answered(kim), "silence")
        with raw("kim") as session, pytest.raises(errors.NoAnswer, match="revoked"):
            bus.ask(
                session, keys.commands_as("kim"), "get", commands.Get(name="kims1"), object, patience_s=0.5
            )
    with as_("vera") as vera:
        until(lambda: _answered(vera), "an answer to another")
        assert vera.history("kims1")[0].agent == "kim"


def test_changes_are_executed_once_while_the_router_restarts(as_, folder):
    """An interrupted request may have been executed; it is sent again and identified by its id."""
    made, guest = [], ""
    with as_("bob") as bob:
        before = bob.status().commit
        for n in range(COUNT):
            if n % 15 == 7:
                guest = f"guest{n}"
                authority.add(folder, guest, "viewer")
            made.append(bob.add("Cup", f"once{n}", at=(5.0, 2.0 + n / 20, 0.75)).commit)
            time.sleep(0.02)
        commits = [c for c in bob.history(since=before + 1, limit=1000) if c.verb == "add"]
    assert [c.seq for c in commits] == made
    assert [c.changed[0] for c in commits] == [f"once{n}" for n in range(COUNT)]
    with as_(guest) as last:  # otherwise the router restarts during the next test
        until(lambda: _answered(last), "an answer to the last guest")


def _answered(client):
    try:
        client.get("fridge1")
    except errors.SemmapError:
        return False
    return True


def test_forbidden_subscriptions_are_reported(system, folder):
    said = system.cli("watch", "semmap/**", "--identity", folder / "vera", status=1)
    assert "role 'viewer' of your certificate may not subscribe to 'semmap/**'; use one of: " in said


def test_what_is_live_comes_from_robots_and_is_heard_by_all(as_):
    with as_("bob") as bob, as_("spot") as spot, as_("vera") as vera:
        bob.add("Ball", "ball7", at=(3.0, 3.0, 0.0), track="stream")

        def is_live():
            spot.publish_pose("ball7", at=(2.0, 3.0, 0.0))
            live = vera.get("ball7").live
            return live is not None and live.pose.position_m == (2.0, 3.0, 0.0)

        until(is_live, "a viewer sees the robot's live pose")

        def lidar_pose():
            spot.publish_frame("spot/lidar", "ball7", at=(0.0, 0.0, 0.3), fixed=True)
            return [frame.map_pose for frame in vera.frames() if frame.name == "spot/lidar"]

        placed = until(lidar_pose, "a viewer sees the robot's frame")
        assert placed[0].position_m == pytest.approx((2.0, 3.0, 0.3))
        for name in ("vera", "bob", "eye"):
            with as_(name) as client:
                with pytest.raises(errors.Refused, match="may not publish on semmap/live"):
                    client.publish_pose("ball7", at=(0.0, 0.0, 0.0))
                with pytest.raises(errors.Refused, match="may not publish on semmap/frame"):
                    client.publish_frame("spot/lidar", "map")
        bob.track("ball7", off=True)
        spot.withdraw_frame("spot/lidar")


def test_a_viewer_publishes_the_map_to_ros(system, folder):
    endpoint = free_endpoint()
    with bus.open_session(bus.Network(connect=(), listen=(endpoint,), mode="router")):
        words = ("ros", "--router", endpoint, "--identity", str(folder / "vera"))
        with system.spawned(*words, stderr=subprocess.PIPE) as process:
            assert any("entities as of commit" in line for line in process.stderr)
            process.stderr.close()


@pytest.mark.parametrize("name", ["vera", "spot", "eye"])
def test_only_operators_have_things_held_tracked_and_driven(as_, name):
    with as_(name) as client:
        for ask in (
            lambda: client.attach("milk1", to="table1"),
            lambda: client.detach("milk1"),
            lambda: client.track("milk1"),
            lambda: client.drive("table1", to=((0.0, 0.0),), frame="map"),
            lambda: client.move("milk1", at=(0.0, 0.0, 0.0), frame="kitchen1"),
        ):
            with pytest.raises(errors.Refused, match="required role: 'operator' or 'admin'"):
                ask()
    with as_("bob") as bob:
        assert "milk1 is attached to table1" in bob.attach("milk1", to="table1", force=True).text
        assert "milk1 is detached from table1" in bob.detach("milk1").text


def test_live_data_cannot_be_forged_without_the_role(as_, raw):
    with as_("bob") as bob, as_("spot") as spot, raw("vera") as vera, raw("bob") as forger:
        for ball in ("ball8", "ball9"):
            bob.add("Ball", ball, at=(3.0, 3.0, 0.0), track="stream")
        for name, session in (("vera", vera), ("bob", forger)):
            session.put("semmap/live/ball8", json.dumps({"at": [0, 0, 0]}), encoding="application/json")
            session.put("semmap/frame/dock8", json.dumps({"parent": "map", "fixed": True}))
            # The reply comes after the router has handled the publications of this session.
            bus.ask(session, keys.commands_as(name), "get", commands.Get(name="ball8"), object)

        def is_live():
            spot.publish_pose("ball9", at=(2.0, 3.0, 0.0))
            return bob.get("ball9").live

        until(is_live, "a later pose of a robot")
        assert bob.get("ball8").live is None
        assert "dock8" not in {frame.name for frame in bob.frames()}
