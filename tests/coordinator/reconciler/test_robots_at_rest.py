"""A robot and its parts are committed together, and added in a fixed order."""

from concurrent.futures import Future
from types import SimpleNamespace

import pytest
from msgspec import structs

from semmap.nodes.coordinator.config import CoordinatorConfig
from semmap.nodes.coordinator.reconciler import reconciler as module
from semmap.nodes.coordinator.reconciler.reconcile import body_order
from semmap.nodes.coordinator.reconciler.reconciler import Reconciler
from semmap.nodes.coordinator.reconciler.rest_waits import CALM_S
from semmap.schemas import commands as c
from semmap.schemas import errors
from semmap.schemas.entities import Pose
from semmap.schemas.joints import Joint
from semmap.schemas.scenes import Body, BodyOrder
from tests.coordinator.conftest import immediate
from tests.coordinator.reconciler.test_reconciler import standing

ARM = Joint(name="arm", kind="hinge", lower=-1.0, upper=1.0)


@pytest.fixture
def reconciler(dispatcher):
    """A robot with a gripper and a hand, which drove one metre, and a chair that was pushed."""
    reconciler = Reconciler(
        CoordinatorConfig("map"), dispatcher, immediate(dispatcher), lambda call: Future(), lambda text: None
    )
    reconciler.scene.known = True
    for name in ("robot1", "gripper1", "hand1", "chair1"):
        dispatcher.change(c.Add(class_="Chair", name=name, at=(0.0, 0.0, 0.0)))
    for name, entity in dispatcher.map.entities.items():
        body = standing(body_order(entity, entity.pose))
        whole = {"gripper1": "robot1", "hand1": "gripper1"}.get(name, "")
        there = Pose(position_m=(1.0, 0.0, 0.0))
        body = structs.replace(body, robot=name != "chair1", part_of=whole, pose=there, entity=False)
        reconciler.scene.bodies[name] = body
    return reconciler


def have(reconciler: Reconciler, name: str, **what: object) -> None:
    reconciler.scene.bodies[name] = structs.replace(reconciler.scene.bodies[name], **what)


def stands_at_m(dispatcher, name: str) -> float:
    return dispatcher.map.entity(name).pose.position_m[0]


@pytest.mark.parametrize("moving", ["robot1", "gripper1", "hand1"])
def test_it_is_committed_completely_once_all_parts_rest(dispatcher, reconciler, moving):
    have(reconciler, moving, resting=False)
    seq = dispatcher.map.seq
    reconciler.reconcile()
    assert dispatcher.map.seq == seq + 1  # the chair's
    assert {stands_at_m(dispatcher, name) for name in ("robot1", "gripper1", "hand1")} == {0.0}
    assert not reconciler.agreement().holds
    have(reconciler, moving, resting=True)
    reconciler.reconcile({moving})
    assert dispatcher.map.seq == seq + 2
    assert {stands_at_m(dispatcher, name) for name in ("robot1", "gripper1", "hand1")} == {1.0}
    reconciler.reconcile()
    assert dispatcher.map.seq == seq + 2
    assert reconciler.agreement().holds


def test_how_its_joints_stand_is_in_that_commit(dispatcher, reconciler):
    have(reconciler, "robot1", joints=(structs.replace(ARM, position=0.5),))
    seq = dispatcher.map.seq
    reconciler.reconcile({"robot1"})
    assert dispatcher.map.seq == seq + 1
    assert dispatcher.map.entity("robot1").properties["jointPositions"] == "arm=0.5"
    assert stands_at_m(dispatcher, "hand1") == 1.0


def test_the_joints_of_a_part_come_too(dispatcher, reconciler):
    for name in ("robot1", "gripper1"):
        have(reconciler, name, joints=(structs.replace(ARM, position=0.5),))
    reconciler.reconcile()
    reconciler.reconcile()
    for name in ("robot1", "gripper1"):
        assert dispatcher.map.entity(name).properties["jointPositions"] == "arm=0.5"


def test_an_arm_that_never_rests_is_waited_for_in_simulated_time_only(dispatcher, reconciler, monkeypatch):
    have(reconciler, "hand1", resting=False)
    hours = SimpleNamespace(monotonic=(3600.0 * i for i in range(9)).__next__)
    monkeypatch.setattr(module, "time", hours, raising=False)  # as on a very busy machine
    for _ in range(3):
        reconciler.reconcile()
    assert [stands_at_m(dispatcher, name) for name in ("robot1", "gripper1", "hand1")] == [0.0, 0.0, 0.0]
    reconciler.scene.sim_time_s += CALM_S
    reconciler.reconcile()
    assert [stands_at_m(dispatcher, name) for name in ("robot1", "gripper1", "hand1")] == [1.0, 1.0, 0.0]


def test_a_robot_that_drove_on_is_waited_for_again_where_it_stops_next(dispatcher, reconciler):
    """Its gripper rests last after each stop; the wait at the first must not count at the second."""
    parts = ("robot1", "gripper1", "hand1")
    have(reconciler, "gripper1", resting=False)
    reconciler.reconcile()
    seq = dispatcher.map.seq
    for name in parts:
        have(reconciler, name, resting=False, pose=Pose(position_m=(2.0, 0.0, 0.0)))
    reconciler.reconcile(parts)
    reconciler.scene.sim_time_s += 10.0
    for name in ("robot1", "hand1"):
        have(reconciler, name, resting=True)
    reconciler.reconcile(parts)
    assert dispatcher.map.seq == seq
    have(reconciler, "gripper1", resting=True)
    reconciler.reconcile({"gripper1"})
    assert dispatcher.map.seq == seq + 1
    assert {stands_at_m(dispatcher, name) for name in parts} == {2.0}


def test_while_it_drives_only_its_own_agreement_fails(dispatcher, reconciler):
    for name in ("robot1", "gripper1", "hand1"):
        have(reconciler, name, resting=False)
    reconciler.reconcile()
    found = reconciler.agreement()
    assert found == (False, (), ("robot1 is moving: 1 m from its committed pose",))
    assert reconciler.agreement({"chair1"}) == (True, (), ())
    assert reconciler.agreement({"robot1", "chair1"}).holds is False
    assert reconciler.problems() == []


def test_whose_agreement_is_asked_for_must_be_there(reconciler):
    with pytest.raises(errors.UnknownName, match="'robot2'; did you mean robot1"):
        reconciler.agreement({"chair1", "robot2"})


@pytest.fixture
def newcomer(dispatcher):
    """A new robot with a gripper, whose arm has sunk under its weight."""
    reconciler = Reconciler(
        CoordinatorConfig("map"), dispatcher, immediate(dispatcher), lambda call: Future(), lambda text: None
    )
    reconciler.scene.known = True
    bodies = [
        new("hand1", part_of="gripper1"),
        new("gripper1", part_of="robot1"),
        new("robot1", joints=(structs.replace(ARM, position=0.12),)),
    ]
    reconciler.scene.bodies.update((body.name, body) for body in bodies)
    return reconciler


def new(name: str, **what: object) -> Body:
    made = standing(BodyOrder(name=name, class_="Chair", pose=Pose(position_m=(0.0, 0.0, 0.0)), commit=0))
    return structs.replace(made, entity=False, robot=True, **what)


@pytest.mark.parametrize("moving", ["", "robot1", "gripper1", "hand1"])
def test_a_new_robot_is_added_in_one_order_and_number_of_commits_whatever_rests_first(
    dispatcher, newcomer, moving
):
    seq = dispatcher.map.seq
    if moving:
        have(newcomer, moving, resting=False)
        newcomer.reconcile()
        assert dispatcher.map.seq == seq
        have(newcomer, moving, resting=True)
    for _ in range(5):
        newcomer.reconcile()
    entities = dispatcher.map.entities
    added = [entities[name].provenance.commit for name in ("robot1", "gripper1", "hand1")]
    assert added == [seq + 1, seq + 2, seq + 3]
    assert dispatcher.map.seq == seq + 3
    assert entities["robot1"].properties["jointPositions"] == "arm=0.12"
    assert newcomer.agreement().holds


def test_a_new_robot_one_part_of_which_never_rests_is_added_after_a_while(dispatcher, newcomer):
    have(newcomer, "hand1", resting=False)
    newcomer.reconcile()
    assert not dispatcher.map.entities
    newcomer.scene.sim_time_s += CALM_S
    for _ in range(3):
        newcomer.reconcile()
    assert [*dispatcher.map.entities] == ["robot1", "gripper1"]


def test_a_new_robot_is_added_without_its_joints_to_a_map_that_has_no_property_for_them(dispatcher, newcomer):
    change = immediate(dispatcher)

    def reject(asked):
        if not any(words.startswith("jointPositions") for words in getattr(asked, "set", ())):
            return change(asked)
        future = Future()
        future.set_exception(errors.BadRequest("the ontology has no property jointPositions"))
        return future

    reconciler = Reconciler(
        CoordinatorConfig("map"), dispatcher, reject, lambda call: Future(), lambda text: None
    )
    reconciler.scene.known = True
    reconciler.scene.bodies.update(newcomer.scene.bodies)
    for _ in range(5):
        reconciler.reconcile()
    assert [*dispatcher.map.entities] == ["robot1", "gripper1", "hand1"]
    assert reconciler.agreement().holds
