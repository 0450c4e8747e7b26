"""Attachments: the last change wins, and an attached body is placed by its holder."""

import pytest
from msgspec import structs

from semmap.nodes.coordinator.commands import attachment_rules
from semmap.nodes.coordinator.reconciler.reconcile import reconcile
from semmap.schemas.attachments import grip_of, holder_of, pose_of_text, pose_text
from semmap.schemas.entities import Pose, compose, relative
from semmap.schemas.errors import Refused
from semmap.schemas.scenes import GripOrder
from tests.coordinator.reconciler.test_reconcile import THRESHOLDS, at, body, entity, provenance

GRIP = Pose(position_m=(0.1, 0.0, 0.3))


def cup(holder: str = "", *, commit: int = 0, source: str = "operator", grip: Pose | None = GRIP):
    known = entity("cup1", at(0.0))
    said = {"isGraspedBy": holder} if holder else {}
    if holder and grip is not None:
        said["graspPose"] = pose_text(grip)
    return structs.replace(
        known, properties=said, grip_provenance=provenance(commit, source) if commit else None
    )


def held(holder: str = "", *, commit: int = -1, x=0.0, grip: Pose | None = GRIP):
    known = body("cup1", at(x))
    return structs.replace(known, held_by=holder, grip=grip if holder else None, grip_commit=commit)


def kept(entity_, body_, truth="map", there=("cup1", "tray1")):
    return reconcile({"cup1": entity_}, {"cup1": body_}, truth, THRESHOLDS, {}, there)


@pytest.mark.parametrize(
    ("said", "stands", "holder", "follows"),
    [
        (cup(), held(), None, False),
        (cup("tray1", commit=5), held(), "tray1", False),
        (cup("tray1", commit=5), held("tray1", commit=5), None, False),
        (cup("tray1", commit=5), held("table1", commit=4), "tray1", False),
        (cup("", commit=6), held("tray1", commit=5), "", False),
        (cup("tray1", commit=5), held("", commit=5), None, True),
        (cup("tray1", commit=5, source="scene"), held("", commit=4), None, True),
        (cup("tray1", commit=5, source="scene"), held(), "tray1", False),
        (cup(), held("tray1", commit=0), None, True),
        (cup("tray1", commit=5, grip=None), held("tray1", commit=5), None, True),
    ],
)
def test_the_last_change_wins(said, stands, holder, follows):
    actions = kept(said, stands)
    orders = () if holder is None else (GripOrder(
        name="cup1", holder=holder, grip=GRIP if holder else None, commit=said.grip_provenance.commit
    ),)  # fmt: skip
    assert actions.grips == orders
    assert actions.gripped == (("cup1",) if follows else ())


def test_an_attached_body_is_neither_placed_nor_followed():
    actions = kept(cup("tray1", commit=5), held("tray1", commit=5, x=9.0))
    assert not any(actions)


def test_a_holder_without_a_body_is_waited_for():
    assert not any(kept(cup("tray1", commit=5), held(), there=("cup1",)))


def test_where_the_scene_is_the_truth_the_map_follows_it():
    assert kept(cup("tray1", commit=5), held(), truth="scene").gripped == ("cup1",)
    assert not any(kept(cup("tray1", commit=5), held("tray1"), truth="scene"))


def test_a_grip_is_a_text_and_back():
    turned = Pose(position_m=(0.1, -2.0, 0.3), orientation_wxyz=(0.6, 0.0, 0.0, 0.8))
    assert pose_of_text(pose_text(turned)) == turned
    assert [pose_of_text(text) for text in ("", "1 2 3", "a b c d e f g", "0 0 0 9 0 0 0")] == [None] * 4
    frame = Pose(position_m=(1.0, 2.0, 0.0), orientation_wxyz=(0.8, 0.0, 0.0, 0.6))
    assert compose(frame, relative(turned, frame)).position_m == pytest.approx(turned.position_m)


def test_circles_are_refused():
    tray = structs.replace(entity("tray1", at(0.0)), properties={"isGraspedBy": "robot1"})
    robot = structs.replace(entity("robot1", at(0.0)), properties={"isDirectPartOf": ("cup1",)})
    there = {"cup1": cup(), "tray1": tray, "robot1": robot}
    with pytest.raises(Refused, match="tray1 moves with cup1, so cup1 cannot be attached to it"):
        attachment_rules.require_attachable(there["cup1"], tray, there, {})
    attachment_rules.require_attachable(tray, robot, there, {})


def test_its_pose_follows_from_its_holder():
    said = cup("tray1", commit=5)
    assert (holder_of(said), grip_of(said)) == ("tray1", GRIP)
    where = {"tray1": Pose(position_m=(2.0, 0.0, 1.0), orientation_wxyz=(0.0, 0.0, 0.0, 1.0))}.get
    assert attachment_rules.attached_pose(said, where).position_m == pytest.approx((1.9, 0.0, 1.3))
    assert attachment_rules.attached_pose(cup(), where) is None
    assert attachment_rules.compute_grip(None, where("tray1"), None, None) is None
    assert attachment_rules.compute_grip(None, None, (1.0, 0.0, 0.0), None).position_m == (1.0, 0.0, 0.0)


def taken(name: str, holder: str, commit: int):
    grip = provenance(commit, "operator")
    return structs.replace(entity(name, at(0.0)), properties={"isGraspedBy": holder}, grip_provenance=grip)


def test_contents_are_detached_together():
    tray = taken("tray1", "gripper1", 7)
    others = [taken("cup1", "tray1", 7), taken("cup2", "tray1", 8), taken("apple1", "gripper1", 7)]
    there = {e.name: e for e in (tray, *others)}
    assert attachment_rules.find_attached_with(tray, there) == ("cup1",)
    assert attachment_rules.find_attached_with(entity("table1", at(0.0)), there) == ()


def test_fixed_parts_and_attached_objects_are_not_carried():
    tray, gripper = entity("tray1", at(0.0)), entity("gripper1", at(0.0))
    there = {
        "cup1": cup(),
        "hook1": structs.replace(entity("hook1", at(0.0)), fixed=True),
        "lid1": entity("lid1", at(0.0)),
        "apple1": taken("apple1", "person1", 3),
    }
    bodies = {"lid1": structs.replace(body("lid1", at(0.0)), part_of="pot1")}
    assert attachment_rules.find_load((*there, "gone1"), tray, gripper, there, bodies) == ("cup1",)


def test_an_object_is_not_attached_to_its_contents():
    tray, person = entity("tray1", at(0.0)), taken("person1", "cup1", 3)
    there = {"tray1": tray, "person1": person, "cup1": cup()}
    with pytest.raises(Refused, match=r"^person1 is on or inside tray1, so tray1 cannot be attached"):
        attachment_rules.find_load(("person1",), tray, person, there, {})
    with pytest.raises(Refused, match=r"^cup1, which carries person1, is on or inside tray1"):
        attachment_rules.find_load(("cup1",), tray, person, there, {})
