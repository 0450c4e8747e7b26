"""Replies and rejections of the commands that change entities."""

from __future__ import annotations

import pytest
from msgspec import structs

from semmap.nodes.coordinator.commands.entity_changes import adopt_observed, require_removable
from semmap.nodes.coordinator.reconciler.observed_state import ObservedState
from semmap.nodes.coordinator.scene.manual_moves import Attribution
from semmap.schemas import commands as c
from semmap.schemas import errors
from semmap.schemas.commits import Effects
from semmap.schemas.entities import Pose
from semmap.schemas.joints import Joint
from tests.coordinator.reconciler.test_scene_report import body, entity


def add(dispatcher, name=None, class_="Chair", **fields):
    return dispatcher.change(c.Add(class_=class_, name=name, **fields))


def test_the_replies_name_what_was_added_tracked_and_removed(dispatcher):
    assert add(dispatcher, "chair1", at=(1.0, 2.5, 0.0)).text == "added Chair chair1 at (1, 2.5, 0)"
    track = c.Track(name="chair1", from_="stream")
    assert dispatcher.change(track).commit == 2
    again = dispatcher.change(track)
    assert (again.commit, again.text) == (None, "unchanged: chair1 is tracked from a stream of poses already")
    dispatcher.change(c.Track(name="chair1", from_="sim"))
    assert dispatcher.change(c.Track(name="chair1", from_="sim")).text == (
        "unchanged: chair1 is tracked from the simulator already"
    )
    dispatcher.change(c.Track(name="chair1", off=True))
    assert dispatcher.change(c.Track(name="chair1", off=True)).text == "unchanged: chair1 is not tracked"
    add(dispatcher, "chair2", at=(3.0, 2.0, 0.0))
    removed = dispatcher.change(c.Remove(names=("chair2", "chair1", "chair2")))
    assert (removed.text, removed.names) == ("removed 2: chair2 and chair1", ("chair2", "chair1"))
    assert dispatcher.change(c.Clear()).text == "the map is already empty"


def test_a_place_is_not_tracked_and_nothing_is_not_removed(dispatcher):
    add(dispatcher, "kitchen1", "Kitchen", size=(3.0, 3.0, 2.0))
    with pytest.raises(errors.Refused, match="kitchen1 is a place and does not move"):
        dispatcher.change(c.Track(name="kitchen1", from_="stream"))
    with pytest.raises(errors.BadRequest, match="name at least one entity"):
        dispatcher.change(c.Remove(names=()))


def test_entities_without_a_pose_get_different_places(dispatcher):
    add(dispatcher, "chair1")
    add(dispatcher, "chair2")
    first, second = (dispatcher.map.entity(name).pose.position_m for name in ("chair1", "chair2"))
    assert first != second


def test_a_label_by_default_is_that_of_the_class(dispatcher):
    add(dispatcher, "a", default=True)
    add(dispatcher, "b", "Living_Room_Table", default=True)
    add(dispatcher, "c")
    add(dispatcher, "d", default=True, ref="throne")
    labels = [dispatcher.map.entity(name).preferred_reference for name in "abcd"]
    assert labels == ["chair", "living room table", None, "throne"]


def test_a_rename_to_the_same_name_changes_nothing(dispatcher):
    add(dispatcher, "chair1")
    reply = dispatcher.change(c.Rename(name="chair1", new="chair1"))
    assert (reply.commit, reply.text) == (None, "unchanged: the name is already chair1")


def test_perception_may_not_resize_relabel_or_reclassify_what_an_operator_added(dispatcher):
    add(dispatcher, "chair1", size=(0.5, 0.5, 1.0))
    for fields in ({"size": (0.6, 0.5, 1.0)}, {"alt": ("stool",)}, {"class_": "Furniture"}):
        with pytest.raises(errors.Refused, match="operator"):
            dispatcher.change(c.Update(name="chair1", source="perception", **fields))
    assert dispatcher.change(c.Update(name="chair1", source="perception", at=(4.0, 4.0, 0.0))).commit == 2


def test_robots_of_the_simulator_are_not_removed():
    bodies = {
        "robot1": body("robot1", robot=True),
        "arm1": body("arm1", robot=True, part_of="robot1"),
        "cup1": body("cup1"),
    }
    require_removable(["cup1", "plate1"], bodies)
    with pytest.raises(errors.Refused, match="robot1 is the robot of the simulator"):
        require_removable(["cup1", "robot1"], bodies)
    with pytest.raises(errors.Refused, match="arm1 is part of robot1, a robot of the simulator"):
        require_removable(["arm1"], bodies)


class View:
    """A map with `cup1` and `box1`, which takes each commit."""

    def __init__(self):
        self.entities = {
            name: entity(name, pose=Pose(position_m=(0.0, 0.0, 0.0))) for name in ("cup1", "box1")
        }

    def reserve(self, transaction):
        return transaction

    def take(self, commit):
        return True

    def confirm(self, seq, digest):
        pass


DOOR = Joint(name="door", kind="hinge", lower=0.0, upper=1.5, closed=0.0, position=1.5)
BY_HAND = Attribution("move", "ann", "cup1 was moved by hand")
BY_ITSELF = Attribution("", "", "cup1 came to rest")


def adopted(observed, cause, view=None):
    """Return the transaction of an observed state, and the reply."""
    running = adopt_observed(view or View(), observed, cause)
    try:
        asked = next(running)
        running.send(Effects(seq=8, id=asked.id))
    except StopIteration as end:
        return (asked if end.value.commit else None), end.value
    raise AssertionError("it asks for more")


@pytest.mark.parametrize(
    ("cause", "joints", "reason"),
    [
        (BY_HAND, {}, "cup1 was moved by hand"),
        (BY_ITSELF, {}, "cup1 came to rest"),
        (BY_HAND, {"box1": (DOOR,)}, "cup1 was moved by hand"),
        (BY_ITSELF, {"box1": (DOOR,)}, "box1 was opened to 100% in the scene"),
    ],
)
def test_an_observed_state_has_the_reason_of_the_client_or_of_the_scene(cause, joints, reason):
    view = View()
    observed = ObservedState.of(view.entities, {"cup1": Pose(position_m=(1.0, 0.0, 0.0))}, joints)
    made, reply = adopted(observed, cause, view)
    assert (made.reason, made.agent, made.verb, made.source) == (reason, cause.agent, cause.verb, "scene")
    assert reply.text == reason
    assert set(reply.names) == {"cup1", *joints}
    told, _ = adopted(observed._replace(reason="told"), cause)
    assert told.reason == "told"


def test_the_state_of_entities_that_changed_since_is_not_committed():
    view = View()
    observed = ObservedState.of(view.entities, {"cup1": Pose(position_m=(1.0, 0.0, 0.0))})
    view.entities["cup1"] = structs.replace(
        view.entities["cup1"], pose_provenance=structs.replace(view.entities["cup1"].provenance, commit=9)
    )
    with pytest.raises(StopIteration) as end:
        next(adopt_observed(view, observed, BY_HAND))
    assert (end.value.value.commit, end.value.value.text) == (None, "unchanged: already up to date")


def test_class_and_name_in_the_wrong_order_are_explained(dispatcher):
    with pytest.raises(errors.UnknownClass) as told:
        dispatcher.change(c.Add(class_="thing1", name="chair"))
    assert told.value.text == (
        "unknown class 'thing1'; the class comes before the name: semmap add chair thing1"
    )
