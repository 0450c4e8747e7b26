"""The ten test cases of the system that semmap replaces, end to end: spawned processes, real Zenoh peers."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from semmap.nodes import bus
from semmap.nodes.extern.client import connect
from semmap.schemas import errors, keys
from semmap.schemas.bridge import SnapshotQuery
from semmap.schemas.commits import Snapshot
from semmap.schemas.scenes import Scene, SceneQuery
from tests.conftest import free_endpoint, until

NODES = ("coordinator", "kb_node", "sim_node", "recorder")


@pytest.fixture(scope="module")
def flat(full_system):
    """The shipped flat, initialised from a non-empty TBox and ABox, with all nodes."""
    with full_system.client() as client:
        until(lambda: client.status().in_agreement, "map and scene agree")
    return full_system


@pytest.fixture
def client(flat):
    with flat.client() as client:
        yield client


def body_of(client, name):
    return client.get(name).body


def test_1_initialise_from_a_non_empty_tbox_and_abox(flat, client):
    status = client.status()
    assert status.entities >= 40
    assert {n.node: n.state for n in status.nodes} == dict.fromkeys(NODES, "ready")
    assert len(client.classes()) >= 170


def test_2_collect_the_instances_and_render_them(client):
    entities = client.list()
    assert {e.body.status for e in entities if e.place} == {"none"}
    assert {e.body.status for e in entities if not e.place} == {"present"}
    assert client.status().bodies >= sum(not e.place for e in entities)


def test_3_list_the_properties_of_active_entities(flat, client):
    fridge = client.get("fridge1")
    assert fridge.class_ == "Fridge"
    assert {"Appliance", "Device", "Object", "Physical_Thing"} <= set(fridge.types)
    assert fridge.pose is not None
    assert fridge.size_m is not None
    assert fridge.preferred_reference == "fridge"
    assert fridge.provenance.source == "file"
    shown = flat.cli("get", "fridge1")
    assert "fridge" in shown
    assert "Appliance" in shown


def test_4_drag_an_object_and_see_the_abox_follow(client):
    client.add("Box", "box_to_drag", at=(2.0, 1.2, 0.0), size=(0.2, 0.2, 0.2), wait=True)
    client.move("box_to_drag", (2.0, 2.4, 0.3))

    def followed():
        pose = client.get("box_to_drag").pose
        return pose if pose.position_m[1] > 2.0 else None

    x, y, z = until(followed, "the map follows the hand").position_m
    assert (x, y, z) == pytest.approx((2.0, 2.4, 0.0), abs=0.06)
    assert client.get("box_to_drag").pose_provenance.source == "scene"


def test_time_stands_still_goes_on_by_steps_and_bodies_go_back_to_the_map(client):
    def scene():
        return bus.ask(client.session, keys.SIM, "snapshot", SceneQuery(), Scene)

    client.add("Box", "still_box", at=(2.0, 1.8, 0.0), size=(0.2, 0.2, 0.2), wait=True)
    client.pause()
    try:
        client.move("still_box", (2.0, 1.8, 0.8))
        before = scene().sim_time_s
        client.step(0.25)
        assert scene().sim_time_s == pytest.approx(before + 0.25)
        (height,) = (body.pose.position_m[2] for body in scene().bodies if body.name == "still_box")
        assert 0.3 < height < 0.7  # it falls
        client.reset()
        (height,) = (body.pose.position_m[2] for body in scene().bodies if body.name == "still_box")
        assert height == pytest.approx(0.0, abs=0.01)
    finally:
        client.pause(off=True)
    client.remove("still_box")


def test_5_enumerate_the_instances_from_outside(flat):
    assert json.loads(flat.cli("list", "--format", "json", "--class", "Room"))
    selector = "semmap/cmd/list?class=Room;format=json"
    words = ["--mode", "client", "--connect", flat.endpoint, "get", "-s", selector, "--decoder", "text"]
    run = subprocess.run([Path(sys.executable).parent / "zenoh", *words], capture_output=True, text=True)
    assert "kitchen1" in run.stdout


def test_6_check_consistency(client, flat):
    assert client.check().consistent
    with pytest.raises(errors.Inconsistent) as refusal:
        client.load(_nonsense(flat.data))
    assert refusal.value.explanation is not None
    assert "fridge1" in refusal.value.text
    assert "Kitchen" not in client.get("fridge1").types
    assert client.check().consistent


def test_7_delete(client):
    client.add("Cup", "cup_to_go", at=(2.0, 1.2, 0.0), ref="a cup", wait=True)
    client.remove("cup_to_go")
    with pytest.raises(errors.UnknownName):
        client.get("cup_to_go")
    until(lambda: client.status().in_agreement, "the body goes, too")
    assert b"cup_to_go" not in client.export("ntriples").content


def test_8_insert_the_default_instance(client):
    (name,) = client.add("Chair", default=True, wait=True).names
    chair = client.get(name)
    assert chair.preferred_reference == "chair"
    assert chair.body.status == "present"
    client.remove(name)


def test_9_insert_with_type_position_and_reference(client):
    reply = client.add(
        "Beer", "beer_inserted", at=(2.0, 2.0, 0.0), yaw=0.5, ref="cold beer", alt=("lager",), wait=True
    )
    assert "body: present" in reply.text
    beer = client.get("beer_inserted")
    assert beer.pose.position_m[:2] == pytest.approx((2.0, 2.0), abs=0.05)
    assert beer.pose.yaw_rad == pytest.approx(0.5, abs=0.1)
    assert (beer.preferred_reference, beer.alternative_references) == ("cold beer", ("lager",))
    assert "Drinkable" in beer.types
    client.remove("beer_inserted")


@pytest.mark.parametrize("ending", ["owl", "ttl", "nt", "jsonld"])
def test_10_export_to_a_named_file_that_loads_back_equal(flat, client, tmp_path, ending):
    file = tmp_path / f"map.{ending}"
    flat.cli("export", file)
    reply = client.load(file, replace=True)
    assert reply.commit is None, reply.text


# A killed recorder begins another recording; the checks of recordings of this system need the whole of one.
@pytest.mark.parametrize("node", [node for node in NODES if node != "recorder"])
def test_kill_and_restart_any_one_node(flat, client, node):
    before = {e.name: e.pose for e in client.list()}
    pid = flat.pid(node)
    os.kill(pid, signal.SIGKILL)

    def back():
        try:
            status = client.status()
        except errors.NoAnswer:
            return False
        states = {n.node: (n.state, n.pid) for n in status.nodes}
        everybody = set(states) == set(NODES) and {s for s, _ in states.values()} == {"ready"}
        return everybody and states[node][1] != pid and status.in_agreement

    until(back, f"{node} is back and map and scene agree")
    assert {e.name: e.pose for e in client.list()} == before


def test_while_the_knowledge_base_is_away_the_coordinator_says_so(flat, client):
    os.kill(flat.pid("kb_node"), signal.SIGKILL)
    for _ in range(20):
        with contextlib.suppress(errors.NoAnswer):
            client.history()  # has no responder
        with contextlib.suppress(errors.NoAnswer):
            client.sparql("ASK {}")  # has no responder until the coordinator notices
        with flat.client() as newcomer:
            newcomer.status()
    until(lambda: client.status().in_agreement, "map and scene agree again")


def _nonsense(folder: Path) -> Path:
    file = folder / "nonsense.ttl"
    fridge, kitchen = "semantic_mapping_1#fridge1", "semantic_mapping_domain_model#Kitchen"
    base = "http://www.semanticweb.org/ontologies/2016/1/"
    file.write_text(f"<{base}{fridge}> a <{base}{kitchen}> .")
    return file


def test_without_a_system_the_result_is_an_error_and_not_an_empty_list():
    with pytest.raises(errors.NoAnswer), connect(free_endpoint()):
        pass


@pytest.mark.long
def test_a_node_that_hangs_is_killed_and_restarted(empty_scene):
    with empty_scene.client() as client:
        pid = empty_scene.pid("sim_node")
        os.kill(pid, signal.SIGSTOP)
        until(lambda: empty_scene.pid("sim_node") != pid, "another simulator")
        until(lambda: client.status().in_agreement, "map and scene agree")
    assert not Path(f"/proc/{pid}").exists()


def test_one_node_by_itself(tmp_path):
    endpoint = free_endpoint()
    words = ["node", "kb_node", "--abox", "none", "--data", str(tmp_path), "--listen", endpoint]
    command = [Path(sys.executable).parent / "semmap", *words]
    peer = bus.Network(mode="peer", listen=(endpoint,), connect=())
    with bus.open_session(peer) as session, subprocess.Popen(command, stderr=subprocess.DEVNULL) as process:
        snapshot = bus.ask(session, keys.BRIDGE, "snapshot", SnapshotQuery(), Snapshot, patience_s=60)
        process.send_signal(signal.SIGINT)
        assert process.wait(timeout=10) == 0
    assert (snapshot.seq, snapshot.entities) == (1, ())
