"""Contents that a drawer moves are committed with it, in one commit."""

from concurrent.futures import Future

import pytest
from msgspec import structs

from semmap.nodes.coordinator.config import CoordinatorConfig
from semmap.nodes.coordinator.reconciler import rest_waits
from semmap.nodes.coordinator.reconciler.contents import find_contents
from semmap.nodes.coordinator.reconciler.reconcile import body_order
from semmap.nodes.coordinator.reconciler.reconciler import Reconciler
from semmap.schemas import commands as c
from semmap.schemas.entities import Pose
from semmap.schemas.joints import Joint
from semmap.schemas.scenes import Body
from tests.coordinator.conftest import immediate
from tests.coordinator.reconciler.test_reconciler import standing

DRAWER = Joint(name="drawer", kind="slide", lower=0.0, upper=0.3, closed=0.0)


@pytest.fixture
def reconciler(dispatcher):
    """A chest whose drawer was pulled out by 0.3 m, two apples in it and a third one far away."""
    reconciler = Reconciler(
        CoordinatorConfig("map"), dispatcher, immediate(dispatcher), lambda call: Future(), lambda text: None
    )
    reconciler.scene.known = True
    dispatcher.change(c.Add(class_="Chair", name="chest1", at=(0.0, 0.0, 0.0)))
    for name, at in (
        ("apple1", (0.0, 0.1, 0.2)),
        ("apple2", (0.0, -0.1, 0.2)),
        ("apple3", (5.0, 0.0, 0.0)),
    ):
        dispatcher.change(c.Add(class_="Chair", name=name, at=at))
    for name, entity in dispatcher.map.entities.items():
        reconciler.scene.bodies[name] = standing(body_order(entity, entity.pose))
    reconciler.scene.bodies["chest1"] = structs.replace(
        reconciler.scene.bodies["chest1"], joints=(structs.replace(DRAWER, position=0.3),), joint_commit=1
    )
    for name, resting in (("apple1", True), ("apple2", False)):
        pull(reconciler, name, resting=resting)
    return reconciler


def pull(reconciler: Reconciler, name: str, *, resting: bool) -> None:
    body: Body = reconciler.scene.bodies[name]
    y = body.pose.position_m[1]
    moved = structs.replace(body, pose=Pose(position_m=(0.3, y, 0.2)), resting=resting)
    reconciler.scene.bodies[name] = moved


def test_contents_are_found_by_the_box_including_open_drawers(reconciler):
    bodies = reconciler.scene.bodies
    assert find_contents(bodies["chest1"], bodies.values()) == ["apple1", "apple2"]
    held = structs.replace(bodies["apple1"], held_by="robot1")
    above = structs.replace(bodies["apple2"], pose=Pose(position_m=(0.0, 0.0, 0.5)))
    assert find_contents(bodies["chest1"], [held, above]) == []


def test_a_drawer_and_its_contents_are_committed_together_once_all_rest(dispatcher, reconciler):
    seq = dispatcher.map.seq
    reconciler.reconcile()
    assert dispatcher.map.seq == seq
    pull(reconciler, "apple2", resting=True)
    reconciler.reconcile({"chest1", "apple1", "apple2"})
    assert dispatcher.map.seq == seq + 1
    found = dispatcher.map.entities
    assert (found["apple1"].pose.position_m[0], found["apple2"].pose.position_m[0]) == (0.3, 0.3)
    assert found["chest1"].properties["jointPositions"] == "drawer=0.3"
    assert found["chest1"].provenance.reason == "chest1 was opened to 100% in the scene"


def test_a_manual_opening_is_attributed(dispatcher, reconciler):
    pull(reconciler, "apple2", resting=True)
    dispatcher.manual_moves.register(c.Open(name="chest1", agent="ann"))
    reconciler.reconcile()
    assert dispatcher.map.entity("apple1").provenance.reason == "chest1 was opened by hand"
    assert dispatcher.map.entity("apple1").provenance.agent == "ann"
    assert set(dispatcher.change(c.Undo()).names) == {"chest1", "apple1", "apple2"}


def test_the_wait_for_rest_is_limited(dispatcher, reconciler, monkeypatch):
    monkeypatch.setattr(rest_waits, "CALM_S", 0.0)
    seq = dispatcher.map.seq
    reconciler.reconcile()
    assert dispatcher.map.seq == seq + 1
    assert dispatcher.map.entity("apple1").pose.position_m[0] == 0.3
    assert dispatcher.map.entity("apple2").pose.position_m[0] == 0.0


def test_contents_moved_by_a_command_are_committed_together(dispatcher, reconciler):
    dispatcher.change(c.Set(name="chest1", property="openness", values=(1.0,)))
    body = reconciler.scene.bodies["chest1"]
    reconciler.scene.bodies["chest1"] = structs.replace(body, joint_commit=dispatcher.map.seq)
    seq = dispatcher.map.seq
    reconciler.reconcile({"apple1"})
    assert dispatcher.map.seq == seq
    pull(reconciler, "apple2", resting=True)
    reconciler.reconcile({"apple1", "apple2"})
    assert dispatcher.map.seq == seq + 1
