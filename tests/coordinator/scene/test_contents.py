"""What a drawer takes along is followed with it, in one commit."""

from concurrent.futures import Future

import pytest
from msgspec import structs

from semmap.nodes.coordinator.config import CoordinatorConfig
from semmap.nodes.coordinator.scene import rest_waits
from semmap.nodes.coordinator.scene.contents import inside
from semmap.nodes.coordinator.scene.reconcile import order
from semmap.nodes.coordinator.scene.reconciler import Keeping
from semmap.schemas import commands as c
from semmap.schemas.entities import Pose
from semmap.schemas.joints import Joint
from semmap.schemas.scenes import Body
from tests.coordinator.conftest import at_once
from tests.coordinator.scene.test_reconciler import standing

DRAWER = Joint(name="drawer", kind="slide", lower=0.0, upper=0.3, closed=0.0)


@pytest.fixture
def keeping(door):
    """A chest whose drawer was pulled out by 0.3 m, two apples in it and a third one far away."""
    keeping = Keeping(CoordinatorConfig("map"), door, at_once(door), lambda call: Future(), lambda text: None)
    keeping.scene.known = True
    door.change(c.Add(class_="Chair", name="chest1", at=(0.0, 0.0, 0.0)))
    for name, at in (
        ("apple1", (0.0, 0.1, 0.2)),
        ("apple2", (0.0, -0.1, 0.2)),
        ("apple3", (5.0, 0.0, 0.0)),
    ):
        door.change(c.Add(class_="Chair", name=name, at=at))
    for name, entity in door.map.entities.items():
        keeping.scene.bodies[name] = standing(order(entity, entity.pose))
    keeping.scene.bodies["chest1"] = structs.replace(
        keeping.scene.bodies["chest1"], joints=(structs.replace(DRAWER, position=0.3),), joint_commit=1
    )
    for name, resting in (("apple1", True), ("apple2", False)):
        pull(keeping, name, resting=resting)
    return keeping


def pull(keeping: Keeping, name: str, *, resting: bool) -> None:
    body: Body = keeping.scene.bodies[name]
    y = body.pose.position_m[1]
    moved = structs.replace(body, pose=Pose(position_m=(0.3, y, 0.2)), resting=resting)
    keeping.scene.bodies[name] = moved


def test_what_is_inside_is_found_by_the_box_as_far_as_drawers_go(keeping):
    bodies = keeping.scene.bodies
    assert inside(bodies["chest1"], bodies.values()) == ["apple1", "apple2"]
    held = structs.replace(bodies["apple1"], held_by="robot1")
    above = structs.replace(bodies["apple2"], pose=Pose(position_m=(0.0, 0.0, 0.5)))
    assert inside(bodies["chest1"], [held, above]) == []


def test_a_drawer_and_what_it_took_along_are_followed_in_one_commit_once_all_of_it_rests(door, keeping):
    seq = door.map.seq
    keeping.keep()
    assert door.map.seq == seq
    pull(keeping, "apple2", resting=True)
    keeping.keep({"chest1", "apple1", "apple2"})
    assert door.map.seq == seq + 1
    found = door.map.entities
    assert (found["apple1"].pose.position_m[0], found["apple2"].pose.position_m[0]) == (0.3, 0.3)
    assert found["chest1"].properties["jointPositions"] == "drawer=0.3"
    assert found["chest1"].provenance.reason == "chest1 was opened to 100% in the scene"


def test_a_hand_that_opened_it_is_told(door, keeping):
    pull(keeping, "apple2", resting=True)
    door.hands.let_go(c.Open(name="chest1", agent="ann"))
    keeping.keep()
    assert door.map.entity("apple1").provenance.reason == "chest1 was opened by hand"
    assert door.map.entity("apple1").provenance.agent == "ann"
    assert set(door.change(c.Undo()).names) == {"chest1", "apple1", "apple2"}


def test_what_never_rests_is_not_waited_for(door, keeping, monkeypatch):
    monkeypatch.setattr(rest_waits, "CALM_S", 0.0)
    seq = door.map.seq
    keeping.keep()
    assert door.map.seq == seq + 1
    assert door.map.entity("apple1").pose.position_m[0] == 0.3
    assert door.map.entity("apple2").pose.position_m[0] == 0.0


def test_what_a_word_moved_is_followed_together_too(door, keeping):
    door.change(c.Set(name="chest1", property="openness", values=(1.0,)))
    body = keeping.scene.bodies["chest1"]
    keeping.scene.bodies["chest1"] = structs.replace(body, joint_commit=door.map.seq)
    seq = door.map.seq
    keeping.keep({"apple1"})
    assert door.map.seq == seq
    pull(keeping, "apple2", resting=True)
    keeping.keep({"apple1", "apple2"})
    assert door.map.seq == seq + 1
