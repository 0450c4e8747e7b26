"""The simulator without Zenoh: simulated time, its pauses and steps, and what is published."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from semmap.nodes.sim_node import node as module
from semmap.nodes.sim_node.config import CameraConfig, SimConfig
from semmap.nodes.sim_node.node import Simulator
from semmap.schemas import codec, errors, keys
from semmap.schemas.commands import Pause, Reset, StepOnce
from semmap.schemas.scenes import Delete, MoveBodies, Poses, SceneQuery, Spawn
from tests.fake_node import FakeNode
from tests.sim_node.orders import hand, order, pose


class Node(FakeNode):
    """A node whose heartbeats at long work are counted."""

    def __init__(self):
        super().__init__(lambda call: ())
        self.beats = 0

    def tick(self):
        self.beats += 1


class Sim:
    """A simulator whose clock stands still unless the test moves it."""

    def __init__(self, monkeypatch, **config):
        self.now_s, self.published = 100.0, []
        monkeypatch.setattr(module.time, "monotonic", lambda: self.now_s)
        monkeypatch.setattr("semmap.nodes.bus.publisher", lambda *_: SimpleNamespace(put=self._put))
        monkeypatch.setattr("semmap.nodes.bus.subscriber_check", lambda *_: lambda: False)
        self.node = Node()
        self.simulator = Simulator(
            self.node, SimConfig(cameras=CameraConfig(rate_hz=0.0, graphics=False), **config)
        )
        (self._advance,) = self.node.repeated

    def _put(self, payload, encoding):
        self.published.append(codec.decode(bytes(payload), Poses))

    def do(self, message):
        _, handle = self.node.served[keys.SIM][message.VERB]
        return handle(message)

    def advance(self, passed_s):
        self.now_s += passed_s
        self._advance()

    @property
    def sim_s(self):
        return self.simulator._now_s

    @property
    def period_s(self):
        return self.node.periods_s[0]


@pytest.fixture
def sim(monkeypatch):
    made = Sim(monkeypatch)
    yield made
    made.simulator.close()


def spawn(sim, name="box1", z=1.0, **fields):
    return sim.do(Spawn(bodies=(order(name, "box", pose(0.0, 0.0, z), **fields),)))


def test_time_passes_as_on_the_clock_but_never_by_more_than_a_tenth_of_a_second(sim):
    spawn(sim)
    sim.advance(0.02)
    assert sim.sim_s == pytest.approx(0.02, abs=0.003)
    before_s = sim.sim_s
    sim.advance(5.0)
    assert sim.sim_s - before_s == pytest.approx(0.1, abs=0.003)


def rest(sim):
    """Let time pass until nothing moves."""
    for _ in range(200):
        sim.advance(0.1)
        if sim.simulator._world.asleep:
            return
    raise AssertionError("something moves for 20 s")


def test_while_nothing_moves_it_wakes_seldom(sim):
    rest(sim)
    assert sim.period_s == 0.05
    spawn(sim)
    assert sim.period_s == 0.01
    rest(sim)
    assert sim.period_s == 0.05
    before_s = sim.sim_s
    sim.now_s += 9.0
    sim.do(MoveBodies(placements=(hand("box1", pose(1.0, 0.0, 1.0)),)))
    assert sim.period_s == 0.01
    sim.advance(0.02)
    assert sim.sim_s - before_s == pytest.approx(0.02, abs=0.003)  # the time asleep does not count


def test_poses_are_published_twenty_times_a_second_and_after_each_order(sim):
    spawn(sim)
    count = len(sim.published)
    assert sim.published[-1].names == ("box1",)
    for _ in range(10):
        sim.advance(0.01)
    assert len(sim.published) - count == 2
    sim.do(Delete(names=("box1",)))
    assert len(sim.published) - count == 3
    assert sim.published[-1].names == ()


def test_a_pause_stops_time_and_is_told_once(sim):
    assert sim.do(Pause(off=True)).text == "time is already running"
    assert sim.do(Pause()).text == "time is paused"
    assert sim.do(Pause()).text == "time is already paused"
    spawn(sim)
    assert sim.period_s == 0.05
    sim.advance(1.0)
    assert sim.sim_s == 0.0
    assert ", paused" in sim.simulator._summary()
    sim.now_s += 7.0
    assert sim.do(Pause(off=True)).text == "time is running"
    sim.advance(0.03)
    assert sim.sim_s == pytest.approx(0.03, abs=0.003)
    assert ", paused" not in sim.simulator._summary()


def test_a_simulator_may_begin_paused(monkeypatch):
    sim = Sim(monkeypatch, still=True)
    sim.advance(1.0)
    assert sim.sim_s == 0.0
    sim.simulator.close()


def test_a_step_advances_paused_time_by_whole_steps(sim):
    with pytest.raises(errors.Refused, match="time is running; pause it first"):
        sim.do(StepOnce(seconds=1.0))
    sim.do(Pause())
    spawn(sim)
    timestep_s = float(sim.simulator._world.model.opt.timestep)
    assert sim.do(StepOnce(seconds=timestep_s / 10)).text.startswith(f"advanced by {timestep_s:g} s")
    beats, count = sim.node.beats, len(sim.published)
    reply = sim.do(StepOnce(seconds=0.5))
    assert reply.text == f"advanced by 0.5 s to {0.5 + timestep_s:.2f} s"
    assert sim.node.beats - beats >= 10
    assert len(sim.published) == count + 1


def test_replies_to_moves_have_the_time_and_whether_it_passes(sim):
    spawn(sim)
    moved = sim.do(MoveBodies(placements=(hand("box1", pose(1.0, 0.0, 1.0)),)))
    assert not moved.paused
    assert moved.stamp_ns < sim.published[-1].stamp_ns
    sim.do(Pause())
    assert sim.do(MoveBodies(placements=(hand("box1", pose(2.0, 0.0, 1.0)),))).paused


def test_a_reset_counts_the_bodies_that_go_back(sim):
    assert sim.do(Reset()).text == "reset to the ordered poses: 0 bodies"
    spawn(sim)
    assert sim.do(Reset()).text == "reset to the ordered poses: 1 body"


def test_the_more_bodies_move_the_shorter_are_the_turns(sim, monkeypatch):
    timestep_s = float(sim.simulator._world.model.opt.timestep)
    for awake, steps in ((10, 500), (4999, 1), (5001, 1), (2500, 2)):
        monkeypatch.setattr(type(sim.simulator._world), "awake", awake)
        assert sim.simulator._slice_s() == pytest.approx(steps * timestep_s)


def test_the_summary_counts_bodies_and_lists_a_few_ignored_elements(sim, monkeypatch):
    name = sim.simulator._world.name
    assert sim.node.details[-1] == name
    spawn(sim)
    assert sim.simulator._summary() == f"1 body in {name}"
    assert module._few("abcdef") == "a, b, c, d, e, f"
    assert module._few("abcdefgh") == "a, b, c, d, e, f and 2 more"
    assert [one.name for one in sim.do(SceneQuery()).bodies] == ["box1"]
