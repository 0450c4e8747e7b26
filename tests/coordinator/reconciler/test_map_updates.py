"""Which changes of the scene are committed to the map, and what happens if the map rejects one."""

from __future__ import annotations

from concurrent.futures import Future
from types import SimpleNamespace

import pytest
from msgspec import structs

from semmap.nodes.coordinator.config import Thresholds
from semmap.nodes.coordinator.reconciler.map_updates import MapUpdater
from semmap.nodes.coordinator.reconciler.observed_state import ObservedState
from semmap.nodes.coordinator.reconciler.reconcile import Actions
from semmap.nodes.coordinator.scene.manual_moves import ManualMoves
from semmap.schemas import commands as c
from semmap.schemas import errors
from semmap.schemas.entities import Pose
from semmap.schemas.joints import Joint
from semmap.schemas.scenes import Placement
from tests.coordinator.reconciler.test_scene_report import body, entity

HERE, THERE = Pose(position_m=(1.0, 2.0, 0.0)), Pose(position_m=(3.0, 2.0, 0.0))
DOOR = Joint(name="door", kind="hinge", lower=0.0, upper=1.5, closed=0.0, position=0.9)
PLAIN = Joint(name="wheel", kind="hinge", lower=-1.0, upper=1.0, position=0.4)


class Home:
    """A map with `cup1`, `box1` and `robot1`, a scene with their bodies, and all changes and reports."""

    def __init__(self):
        self.entities = {name: entity(name, pose=HERE) for name in ("cup1", "box1", "robot1")}
        self.manual_moves = ManualMoves()
        dispatcher = SimpleNamespace(
            map=SimpleNamespace(entities=self.entities), manual_moves=self.manual_moves
        )
        self.scene = SimpleNamespace(
            bodies={name: body(name, pose=THERE) for name in self.entities}, sim_time_s=0.0
        )
        self.changes, self.futures, self.reports, self.revisit = [], [], [], set()
        self.wanted = Actions()
        self.updater = MapUpdater(
            dispatcher,
            self.scene,
            Thresholds(),
            lambda names: self.wanted,
            self.change,
            self.reports.append,
            self.revisit,
        )

    def change(self, change):
        self.changes.append(change)
        self.futures.append(Future())
        return self.futures[-1]

    def have(self, name, **fields):
        known = self.scene.bodies.get(name) or body(name, pose=THERE)
        self.scene.bodies[name] = structs.replace(known, **fields)

    def update(self, **actions):
        self.updater.update(Actions(**actions))

    def follow(self, *names):
        self.update(follow=placements(*names))


def placements(*names):
    return tuple(Placement(name=name, pose=THERE, commit=0) for name in names)


@pytest.fixture
def home():
    return Home()


def test_a_body_is_committed_once_and_compared_again_when_that_is_done(home):
    home.follow("cup1")
    home.follow("cup1")
    (change,) = home.changes
    assert isinstance(change, ObservedState)
    assert dict(change.poses) == {"cup1": THERE}
    assert home.updater.is_following(["cup1", "other"])
    assert not home.updater.is_following(["box1"])
    assert home.revisit == set()
    home.futures[0].set_result(None)
    assert home.revisit == {"cup1"}
    assert not home.updater.is_following(["cup1"])
    assert home.updater.take_corrections() == ((), (), ())


def test_a_rejected_pose_is_put_back_in_the_scene(home):
    home.follow("cup1")
    home.futures[0].set_exception(errors.Refused("cup1 cannot be there"))
    assert home.reports == ["cup1 was put back, because the map rejected its new pose: cup1 cannot be there"]
    home.follow("cup1")  # it is about to be put back
    assert len(home.changes) == 1
    (placed,) = home.updater.take_corrections().placements
    assert (placed.name, placed.pose, placed.commit) == ("cup1", HERE, 7)
    assert home.updater.take_corrections().placements == ()


def test_what_the_map_does_not_answer_is_reported_and_not_put_back(home):
    home.follow("cup1")
    home.futures[0].set_exception(errors.NoAnswer("the map is being restarted"))
    assert home.reports == ["cup1: the new pose is not committed yet: the map is being restarted"]
    assert home.updater.take_corrections().placements == ()


def test_an_entity_that_was_removed_is_not_put_back(home):
    home.follow("cup1")
    del home.entities["cup1"]
    home.futures[0].set_exception(errors.Refused("gone"))
    assert home.updater.take_corrections().placements == ()


def test_bodies_that_were_carried_together_are_committed_together_once_all_rest(home):
    home.manual_moves.register(c.Move(name="box1", at=(3.0, 2.0, 0.0)), ["cup1"])
    home.wanted = Actions(follow=placements("box1", "cup1"))
    home.have("cup1", resting=False)
    home.follow("box1")
    assert home.changes == []
    home.have("cup1", resting=True)
    home.follow("box1", "cup1")
    (change,) = home.changes
    assert set(change.poses) == {"box1", "cup1"}
    home.futures[0].set_exception(errors.Refused("no"))
    assert home.reports == ["box1 and cup1 were put back, because the map rejected their new poses: no"]
    assert {placed.name for placed in home.updater.take_corrections().placements} == {"box1", "cup1"}


def test_joints_are_committed_and_moved_back_if_the_map_rejects_them(home):
    home.have("box1", joints=(DOOR,))
    home.update(opened=("box1",))
    (change,) = home.changes
    assert dict(change.joints) == {"box1": (DOOR,)}
    assert dict(change.poses) == {}
    home.futures[0].set_exception(errors.Refused("it is locked"))
    assert home.reports == ["the joints of box1 were moved back, because the map rejected them: it is locked"]
    home.update(opened=("box1",))
    assert len(home.changes) == 1
    (order,) = home.updater.take_corrections().joints
    assert order.name == "box1"
    home.update(opened=("box1",))
    assert len(home.changes) == 2


@pytest.mark.parametrize(
    ("actions", "report"),
    [
        ({"opened": ("box1",)}, "box1: joint positions are not committed yet: away"),
        ({"gripped": ("box1",)}, "box1: the attachment is not committed yet: away"),
    ],
)
def test_a_tbox_without_the_properties_is_not_asked_again_and_an_absent_map_is(home, actions, report):
    home.have("box1", joints=(DOOR,), held_by="robot1")
    home.update(**actions)
    home.futures[0].set_exception(errors.NoAnswer("away"))
    assert home.reports == [report]
    home.update(**actions)
    assert len(home.changes) == 2
    home.futures[1].set_exception(errors.BadRequest("unknown property"))
    assert home.updater.without_state == {"box1"}
    home.update(**actions)
    assert len(home.changes) == 2
    assert len(home.reports) == 1


def test_an_attachment_is_committed_with_its_holder_and_reason(home):
    home.have("cup1", held_by="robot1", grip=HERE)
    home.update(gripped=("cup1",))
    (change,) = home.changes
    assert change.reason == "cup1 was attached to robot1 in the scene"
    assert dict(change.grips) == {"cup1": ("robot1", HERE)}
    assert dict(change.poses) == {"cup1": THERE}
    home.futures[0].set_exception(errors.Refused("robot1 is full"))
    assert home.reports == [
        "the attachment of cup1 was restored, because the map rejected the new: robot1 is full"
    ]
    home.update(gripped=("cup1",))
    assert len(home.changes) == 1
    (order,) = home.updater.take_corrections().grips
    assert order.name == "cup1"


def test_a_detached_body_names_its_last_holder_and_an_unknown_holder_is_waited_for(home):
    home.entities["cup1"] = entity("cup1", pose=HERE, properties={"isGraspedBy": "robot1"})
    home.update(gripped=("cup1",))
    (change,) = home.changes
    assert change.reason == "cup1 was detached from robot1 in the scene"
    home.have("box1", held_by="robot9")
    home.update(gripped=("box1",))
    assert len(home.changes) == 1


def test_a_new_size_is_committed_and_kept_out_of_the_map_once_it_is_rejected(home):
    home.update(resized=("cup1",))
    (change,) = home.changes
    assert dict(change.sizes_m) == {"cup1": (0.1, 0.1, 0.1)}
    assert change.reason == "cup1 has another size in the scene"
    home.update(resized=("cup1",))
    assert len(home.changes) == 1
    home.futures[0].set_exception(errors.NoAnswer("away"))
    home.update(resized=("cup1",))
    home.futures[1].set_exception(errors.Refused("too small"))
    assert home.reports == [
        "cup1: its new size is not committed: away",
        "cup1: its new size is not committed: too small",
    ]
    home.update(resized=("cup1",))
    assert len(home.changes) == 2


def adopt(home, name="shelf1", **fields):
    home.have(name, **fields)
    home.update(adopt=(home.scene.bodies[name],))


def test_a_body_at_rest_becomes_an_entity(home):
    adopt(home, resting=False)
    assert home.changes == []
    adopt(home, resting=True, label="red shelf", class_="Shelf")
    (add,) = home.changes
    assert (add.source, add.reason) == ("scene", "shelf1 stands in the scene")
    assert (add.class_, add.name, add.ref, add.track, add.set) == ("Shelf", "shelf1", "red shelf", None, ())
    assert (add.at, add.size) == (THERE.position_m, (0.1, 0.1, 0.1))
    adopt(home)
    assert len(home.changes) == 1


def test_its_doors_are_stated_and_other_joints_are_not(home):
    adopt(home, joints=(PLAIN,))
    assert home.changes[0].set == ()
    adopt(home, "shelf2", joints=(DOOR,))
    assert home.changes[1].set == ("isOpen=true", "openness=0.6", "jointPositions=door=0.9")
    home.futures[1].set_exception(errors.BadRequest("unknown property isOpen"))
    assert home.updater.without_state == {"shelf2"}
    assert home.updater.rejected == {}
    adopt(home, "shelf2")
    assert home.changes[2].set == ()


def test_a_robot_is_tracked_and_its_joints_are_stated_if_they_differ_from_its_model(home):
    adopt(home, "robot2", robot=True, joints=(PLAIN,))
    (add,) = home.changes
    assert add.track == "sim"
    assert add.set == ("jointPositions=wheel=0.4",)
    adopt(home, "robot3", robot=True, joints=(structs.replace(PLAIN, position=0.0),))
    assert home.changes[1].set == ()


def test_a_robot_waits_for_its_parts(home):
    home.have("arm2", robot=True, part_of="robot2", resting=False)
    adopt(home, "robot2", robot=True)
    assert home.changes == []
    home.have("arm2", resting=True)
    adopt(home, "robot2")
    assert [add.name for add in home.changes] == ["robot2"]


def test_a_part_waits_for_its_whole_and_is_part_of_the_nearest_one_that_is_an_entity(home):
    home.have("kitchen1")
    adopt(home, "oven1", part_of="kitchen1")
    assert home.changes == []
    home.entities["kitchen1"] = entity("kitchen1")
    adopt(home, "oven1")
    assert home.changes[0].set == ("isDirectPartOf=kitchen1",)
    home.have("frame1", part_of="kitchen1")
    home.updater.rejected["frame1"] = "it has no class"
    adopt(home, "door1", part_of="frame1")
    assert home.changes[1].set == ("isDirectPartOf=kitchen1",)
    assert home.updater.whole_of(home.scene.bodies["kitchen1"]) == ""


def test_a_rejected_body_is_not_tried_again_and_an_unanswered_one_is(home):
    adopt(home)
    home.futures[0].set_exception(errors.NoAnswer("away"))
    assert home.reports == ["shelf1 cannot become an entity yet: away"]
    adopt(home)
    home.futures[1].set_exception(errors.Refused("inconsistent"))
    assert home.updater.rejected == {"shelf1": "a scene body without a map entity: inconsistent"}
    adopt(home)
    assert len(home.changes) == 2
    adopt(home, "thing1", class_=None)
    assert len(home.changes) == 2
    assert home.updater.rejected["thing1"].startswith("a scene body without a map entity: unknown class")


def test_a_drawer_and_its_contents_are_one_commit_once_they_rest(home):
    drawer = Joint(name="drawer", kind="slide", lower=0.0, upper=0.4, closed=0.0, position=0.3)
    home.have("box1", joints=(drawer,), size_m=(1.0, 1.0, 1.0))
    inside = Pose(position_m=(3.2, 2.0, 0.5))
    home.have("cup1", pose=inside, resting=False)
    follow = (Placement(name="cup1", pose=inside, commit=0),)
    home.update(follow=follow, opened=("box1",))
    assert home.changes == []
    assert home.revisit == {"box1", "cup1"}
    home.have("cup1", resting=True)
    home.update(follow=follow, opened=("box1",))
    (change,) = home.changes
    assert change.names == ("box1", "cup1")
    assert change.poses["cup1"] == inside


def test_contents_that_never_rest_are_waited_for_in_simulated_time(home):
    home.have("box1", joints=(DOOR,), size_m=(1.0, 1.0, 1.0))
    home.have("cup1", pose=Pose(position_m=(3.2, 2.0, 0.5)), resting=False)
    for now_s, count in ((10.0, 0), (11.9, 0), (12.0, 1)):
        home.scene.sim_time_s = now_s
        home.update(opened=("box1",))
        assert len(home.changes) == count


def test_nothing_is_committed_about_suspended_bodies(home):
    resume = home.updater.suspend(["cup1"])
    home.follow("cup1", "box1")
    assert [change.names for change in home.changes] == [("box1",)]
    resume()
    assert home.revisit == {"cup1"}
    home.follow("cup1")
    assert len(home.changes) == 2
