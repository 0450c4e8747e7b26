"""Orders that open and close joints, and the replies if nothing opens or is blocked."""

from concurrent.futures import Future

import pytest
from msgspec import structs

from semmap.nodes.coordinator.config import CoordinatorConfig
from semmap.nodes.coordinator.reconciler.reconciler import Reconciler
from semmap.nodes.coordinator.scene.completion import Completion
from semmap.nodes.coordinator.scene.joint_commands import (
    JointCommands,
    _arrived,
    _on_its_way,
    _require_joints,
    _share,
)
from semmap.schemas import commands as c
from semmap.schemas import errors
from semmap.schemas.entities import Pose
from semmap.schemas.joints import Joint
from semmap.schemas.scenes import Body, JointsMoving, Poses
from tests.coordinator.conftest import immediate


def body(*joints):
    return Body(
        name="thing1", class_="Object", model="box",
        pose=Pose(position_m=(0.0, 0.0, 0.0)), size_m=(1.0, 1.0, 1.0),
        fixed=True, entity=True, ghost=False, resting=True, commit=1, shape_commit=1, joints=joints,
    )  # fmt: skip


NO = "thing1 has no door, lid or drawer to open"
HINGE = Joint(name="hinge1", kind="hinge")
SWITCH = Joint(name="knob1", kind="hinge", lower=0.0, upper=1.0, closed=0.0, switch=True)


@pytest.mark.parametrize(
    ("joints", "said"),
    [
        ((), NO),
        ((HINGE,), f"{NO}: its joint hinge1 has no limits, so it has no closed position"),
        ((Joint(name="neck1", kind="ball"),), f"{NO}: its joint neck1 is a ball joint"),
        ((HINGE, SWITCH), f"{NO}; to switch it: semmap open thing1 --joint knob1"),
    ],
)
def test_the_reason_why_nothing_opens_is_reported(joints, said):
    with pytest.raises(errors.Refused) as refused:
        _require_joints(c.Open(name="thing1"), body(*joints))
    assert str(refused.value) == said


def test_a_joint_with_limits_opens():
    _require_joints(
        c.Open(name="thing1"), body(Joint(name="door", kind="hinge", lower=0.0, upper=1.0, closed=0.0))
    )


DOOR = Joint(name="door", kind="hinge", lower=0.0, upper=2.0, closed=0.0)
DRAWER = Joint(name="drawer", kind="slide", lower=0.0, upper=0.3, closed=0.0)


class FakeSimulator:
    """A fake simulator that records the orders, and moves joints."""

    def __init__(self):
        self.orders, self.failed = [], {}

    def ask(self, call):
        self.orders += call.orders
        future = Future()
        future.set_result(JointsMoving(bodies=(), failed=self.failed))
        return future


@pytest.fixture
def simulator():
    return FakeSimulator()


@pytest.fixture
def reconciler(dispatcher, simulator):
    reconciler = Reconciler(
        CoordinatorConfig("map"), dispatcher, immediate(dispatcher), lambda call: Future(), lambda text: None
    )
    dispatcher.change(c.Add(class_="Chair", name="thing1", at=(0.0, 0.0, 0.0)))
    reconciler.scene.known = True
    reconciler.scene.bodies["thing1"] = body(DOOR, DRAWER, SWITCH)
    return reconciler


@pytest.fixture
def opening(dispatcher, reconciler, simulator):
    return JointCommands(dispatcher, reconciler, Completion("map", dispatcher, reconciler), simulator.ask)


@pytest.mark.parametrize(
    ("command", "openness"),
    [
        (c.Open(name="thing1"), 1.0),
        (c.Open(name="thing1", to=0.3, joint="door"), 0.3),
        (c.Close(name="thing1"), 0.0),
        (c.Close(name="thing1", joint="drawer"), 0.0),
    ],
)
def test_open_moves_joints_to_the_requested_share_and_close_to_zero(opening, simulator, command, openness):
    opening.move(command)
    (order,) = simulator.orders
    assert (order.name, order.joint, order.openness) == ("thing1", command.joint or "", openness)
    assert order.commit is None  # a manual order: the map follows it


def test_an_order_waits_until_the_joints_are_ordered_as_the_map_says(
    opening, dispatcher, simulator, reconciler
):
    """Otherwise it would be lost, for example when an undo has just closed the door."""
    dispatcher.change(c.Set(name="thing1", property="isOpen", values=(True,)))
    reply = opening.move(c.Close(name="thing1"))
    assert not reply.done()
    assert simulator.orders == []
    commit = dispatcher.map.entity("thing1").joints_said.commit
    executed = structs.replace(reconciler.scene.bodies["thing1"], joint_commit=commit)
    reconciler.scene.bodies["thing1"] = executed
    nothing = {"names": (), "poses": (), "resting": (), "commits": ()}
    reconciler.on_poses(Poses(run="r", version=1, stamp_ns=1, sim_time_s=0.0, **nothing))
    assert [order.openness for order in simulator.orders] == [0.0]


@pytest.mark.parametrize(
    ("command", "statement"),
    [(c.Open(name="thing1"), "isOpen true"), (c.Close(name="thing1"), "isOpen false")],
)
def test_without_a_simulator_the_statement_to_make_instead_is_given(opening, reconciler, command, statement):
    reconciler.scene.forget()
    with pytest.raises(errors.NoAnswer, match=f"to change only the map: semmap set thing1 {statement}$"):
        opening.move(command)


@pytest.mark.parametrize(("kind", "verb"), [(c.Open, "open"), (c.Close, "close")])
def test_how_a_switch_is_switched_instead_is_given(kind, verb):
    with pytest.raises(errors.Refused, match=f"semmap {verb} thing1 --joint knob1$"):
        _require_joints(kind(name="thing1"), body(SWITCH))


def test_a_joint_that_there_is_not_is_rejected_with_those_that_there_are():
    with pytest.raises(errors.Refused, match=r"no joint 'window' to open; it has: door, drawer, knob1$"):
        _require_joints(c.Open(name="thing1", joint="window"), body(DOOR, DRAWER, SWITCH))
    _require_joints(c.Open(name="thing1", joint="knob1"), body(DOOR, DRAWER, SWITCH))


def at_shares(door=0.0, drawer=0.0, knob=0.0):
    return body(
        structs.replace(DOOR, position=DOOR.position_at(door)),
        structs.replace(DRAWER, position=DRAWER.position_at(drawer)),
        structs.replace(SWITCH, position=SWITCH.position_at(knob)),
    )


@pytest.mark.parametrize(
    ("command", "there", "said"),
    [
        (c.Open(name="thing1"), at_shares(1.0, 1.0), None),
        (c.Open(name="thing1"), at_shares(1.0, 0.5), "something stops drawer"),
        (c.Open(name="thing1"), at_shares(0.5, 0.5), "something stops door and drawer"),
        (c.Open(name="thing1", to=0.5, joint="door"), at_shares(0.49, 0.0), None),
        (c.Open(name="thing1", joint="knob1"), at_shares(knob=1.0), None),
        (c.Close(name="thing1"), at_shares(knob=1.0), None),
        (c.Close(name="thing1"), at_shares(door=0.1), "something stops door"),
    ],
)
def test_joints_that_miss_their_target_are_reported(command, there, said):
    text = _arrived(command, there)
    assert text.startswith("thing1: ")
    assert text.partition("; ")[2] == (said or "")


@pytest.mark.parametrize(
    ("command", "share", "words"),
    [
        (c.Open(name="thing1"), 1.0, "opening thing1"),
        (c.Open(name="thing1", to=0.3), 0.3, "opening thing1 to 30%"),
        (c.Close(name="thing1"), 0.0, "closing thing1"),
    ],
)
def test_a_thing_is_opened_all_the_way_or_in_part_and_closed(command, share, words):
    assert _share(command) == share
    assert _on_its_way(command, "") == words


def test_a_switch_is_turned():
    assert (
        _on_its_way(c.Open(name="thing1", joint="knob1", to=0.5), "knob1") == "turning knob1 of thing1 to 50%"
    )
    assert _on_its_way(c.Close(name="thing1", joint="knob1"), "knob1") == "turning knob1 of thing1 to 0%"


@pytest.mark.parametrize(
    ("command", "door", "short"),
    [
        (c.Open(name="thing1"), 2.0, ""),
        (c.Open(name="thing1"), 1.97, ""),
        (c.Open(name="thing1"), 1.9, "; something stops door"),
        (c.Open(name="thing1", to=0.5), 1.0, ""),
        (c.Open(name="thing1", to=0.5), 1.1, "; something stops door"),
        (c.Close(name="thing1"), 0.0, ""),
        (c.Close(name="thing1"), 0.5, "; something stops door"),
        (c.Close(name="thing1", joint="drawer"), 0.5, ""),
    ],
)
def test_blocked_joints_are_reported(command, door, short):
    drawer = structs.replace(DRAWER, position=DRAWER.position_at(_share(command)))
    text = _arrived(command, body(structs.replace(DOOR, position=door), drawer, SWITCH))
    assert text.startswith("thing1: ")
    assert ("knob1" in text, "door " in text) == (False, command.joint != "drawer")
    assert text.partition("; something")[1:] == short.partition("; something")[1:]


def test_a_switch_moves_only_by_its_name():
    there = body(DOOR, structs.replace(SWITCH, position=1.0))
    assert "door" not in _arrived(c.Open(name="thing1", joint="knob1"), there)
    assert "knob1" in _arrived(c.Open(name="thing1", joint="knob1"), there)


@pytest.mark.parametrize(
    ("joint", "said"),
    [
        ("dor", "thing1 has no joint 'dor' to close; did you mean door?"),
        ("zzz", "thing1 has no joint 'zzz' to close; it has: door, drawer, knob1"),
    ],
)
def test_an_unknown_joint_is_refused_with_those_that_there_are(joint, said):
    with pytest.raises(errors.Refused) as refused:
        _require_joints(c.Close(name="thing1", joint=joint), body(DOOR, DRAWER, SWITCH))
    assert str(refused.value) == said


def test_a_joint_that_opens_and_a_switch_may_be_named():
    for joint in ("door", "knob1"):
        _require_joints(c.Close(name="thing1", joint=joint), body(DOOR, SWITCH))
    _require_joints(c.Open(name="thing1", joint="knob1"), body(SWITCH))
    with pytest.raises(errors.Refused, match=r"--joint knob1$"):
        _require_joints(c.Close(name="thing1"), body(SWITCH))
