"""The coordinator without Zenoh: from a command to its reply."""

from __future__ import annotations

import pytest

from semmap.nodes.coordinator import node as module
from semmap.nodes.coordinator.config import CoordinatorConfig
from semmap.nodes.coordinator.node import Coordinator
from semmap.nodes.identity import authority
from semmap.schemas import commands as c
from semmap.schemas import errors, keys
from semmap.schemas.entities import Pose
from semmap.schemas.health import Health
from semmap.schemas.live import LivePose
from semmap.schemas.scenes import Poses, Scene, Spawned
from tests.coordinator.conftest import new_dispatcher
from tests.coordinator.reconciler.test_reconciler import standing
from tests.coordinator.reconciler.test_scene_report import body
from tests.fake_node import FakeNode, FakeStream

RUN = {"run": "r", "version": 1, "stamp_ns": 1, "sim_time_s": 0.0}


@pytest.fixture
def streams(monkeypatch):
    """The streams of live poses and frames, in this order."""
    made = []

    def stream(*_, **__):
        made.append(FakeStream())
        return made[-1]

    monkeypatch.setattr("semmap.nodes.bus.NewestSamples", stream)
    monkeypatch.setattr("semmap.nodes.bus.publisher", lambda *_: Published())
    return made


class Published:
    def put(self, payload, encoding):
        self.last = payload


class Simulator:
    """Creates each body where it is ordered."""

    def __init__(self):
        self.bodies, self.failed = {}, {}

    def __call__(self, call):
        if call.VERB == "spawn":
            made = [standing(order) for order in call.bodies if order.name not in self.failed]
            self.bodies.update({one.name: one for one in made})
            return Spawned(bodies=tuple(made), failed=self.failed)
        if call.VERB == "snapshot":
            return Scene(**RUN, world="w", bodies=tuple(self.bodies.values()))
        raise errors.NoAnswer("no response from the simulator")


class System:
    """A coordinator with a knowledge base and perhaps a simulator."""

    def __init__(self, semantic_map, sim=None, truth="map", **config):
        kb = new_dispatcher(semantic_map)._ask
        self.node = FakeNode(kb, sim)
        self.coordinator = Coordinator(self.node, CoordinatorConfig(truth=truth, **config))
        self.do, self.tick = self.node.do, self.node.tick

    def begin(self):
        self.tick()
        return self

    def beat(self, name):
        self.node.publish(keys.HEALTH, Health(node=name, pid=1, started_ns=1, stamp_ns=1, state="ready"))


@pytest.fixture
def system(semantic_map, streams):
    return System(semantic_map).begin()


def test_it_is_ready_with_the_map_and_serves_all_commands(system):
    assert "ready: 0 entities" in system.node.details
    assert system.node.details[-1] == "0 entities"
    assert system.node.served[keys.CMD].keys() >= {kind.VERB for kind in c.COMMANDS.values()}
    assert list(system.node.served) == [keys.CMD]


def test_a_secure_system_serves_certified_clients_too(semantic_map, streams, tmp_path):
    authority.init(folder := tmp_path / "keys")
    system = System(semantic_map, keys=folder)
    assert set(system.node.served) == {keys.CMD, keys.commands_as()}


def test_a_command_that_comes_before_the_map_waits_for_it(semantic_map, streams):
    system = System(semantic_map)
    early = system.do(c.Add(class_="Chair", name="chair1"))
    assert not early.done()
    system.tick()
    system.tick()
    assert early.result().names == ("chair1",)


def test_changes_are_handled_in_order_and_listed(system):
    added = system.do(c.Add(class_="Chair", name="chair1", at=(1.0, 2.0, 0.0)))
    assert added.result().commit == 1
    system.do(c.Update(name="chair1", ref="seat"))
    (chair,) = system.do(c.List())
    assert chair.preferred_reference == "seat"
    system.tick()
    assert system.node.details[-1] == "1 entity"


def test_an_error_is_that_of_the_command(system):
    with pytest.raises(errors.UnknownClass):
        system.do(c.Add(class_="Ghost", name="g")).result()


def test_without_a_simulator_nothing_waits_for_a_body(system):
    made = system.do(c.Add(class_="Chair", name="chair1", wait=True))
    system.beat("sim_node")
    system.tick()
    assert not made.done()  # its scene may still arrive
    system.coordinator._health._last.clear()
    system.coordinator._health._complete_from = 0.0
    system.tick()
    assert made.result().text.startswith("added Chair chair1")
    assert "; body: " in made.result().text


def test_the_reply_waits_for_the_body(semantic_map, streams):
    sim = Simulator()
    system = System(semantic_map, sim).begin()
    system.beat("sim_node")
    sim.failed["chair2"] = "its model file is broken"
    made = [system.do(c.Add(class_="Chair", name=f"chair{i}", at=(i, 2.0, 0.0), wait=True)) for i in (1, 2)]
    dry = system.do(c.Add(class_="Chair", name="chair3", wait=True, dry_run=True))
    assert dry.result().dry_run
    assert not made[0].done()
    system.node.publish(keys.POSES, Poses(**RUN, names=(), poses=(), resting=(), commits=()))
    for _ in range(3):
        system.tick()
    assert made[0].result().text.endswith("; body: present")
    assert made[1].result().text.endswith("; body: failed: its model file is broken")
    assert system.node.details[-1] == "2 entities, 1 body"


def test_the_reply_does_not_wait_for_an_entity_that_was_removed(semantic_map, streams):
    system = System(semantic_map).begin()
    system.beat("sim_node")
    made = system.do(c.Add(class_="Chair", name="chair1", wait=True))
    system.do(c.Remove(names=("chair1",)))
    system.tick()
    assert made.result().text.endswith("; body: removed in the meantime")


@pytest.mark.parametrize("truth", ["map", "scene", "perceived", "replayed"])
def test_robots_of_the_simulator_cannot_be_removed(semantic_map, streams, truth):
    system = System(semantic_map, truth=truth).begin()
    system.do(c.Add(class_="Chair", name="robot1"))
    system.coordinator._reconciler.scene.bodies["robot1"] = body("robot1", robot=True)
    if truth == "replayed":
        assert system.do(c.Remove(names=("robot1",))).result().names == ("robot1",)
    else:
        with pytest.raises(errors.Refused, match="robot1 is the robot of the simulator"):
            system.do(c.Remove(names=("robot1",)))


@pytest.mark.parametrize(("truth", "notes"), [("map", 0), ("scene", 1)])
def test_a_change_that_the_scene_will_override_has_a_note(semantic_map, streams, truth, notes):
    system = System(semantic_map, truth=truth).begin()
    system.do(c.Add(class_="Chair", name="chair1", at=(1.0, 2.0, 0.0)))
    reply = system.do(c.Update(name="chair1", at=(3.0, 2.0, 0.0))).result()
    assert len(reply.notes) == notes


def test_the_last_live_pose_is_committed_before_tracking_ends(system, streams):
    system.do(c.Add(class_="Chair", name="cart1", at=(1.0, 2.0, 0.0), track="stream"))
    streams[0].samples.append((keys.live_pose_key("cart1"), LivePose(at=(4.0, 2.0, 0.0))))
    system.do(c.Track(name="cart1", off=True))
    for step in system.node.idle:
        step()
    cart = system.coordinator._dispatcher.map.entity("cart1")
    assert not cart.tracked
    assert cart.pose == Pose(position_m=(4.0, 2.0, 0.0))
    assert cart.pose_provenance.reason == "cart1 is no longer tracked"


def test_it_takes_new_commands_while_few_wait(system, monkeypatch):
    assert system.node.has_room()
    monkeypatch.setattr(module, "_ROOM", 0)
    assert not system.node.has_room()


def test_a_query_is_left_to_the_knowledge_base_while_it_is_there(system):
    leave = system.node.options["leave"]
    verb = next(iter(keys.OF_THE_MAP))
    assert leave(verb)
    assert not leave("add")
    system.node.nodes.clear()
    assert not leave(verb)


def test_a_large_file_frees_its_memory_when_it_is_loaded(system, monkeypatch):
    freed = []
    monkeypatch.setattr(module, "_release_memory", lambda: freed.append(True))
    scene = c.Load(content=b'{"entities": [{"class": "Chair"}]}', filename="scene.json")
    system.do(scene)
    assert freed == []
    monkeypatch.setattr(module, "_LARGE_FILE", 10)
    system.do(scene)
    assert freed == [True]
