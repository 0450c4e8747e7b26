import math

import pytest
from msgspec import structs

from semmap.nodes.extern.web.views.entities.entity_history import find_place, group_provenance, history_events
from semmap.schemas.changes import Change
from semmap.schemas.entities import Pose, Provenance, orientation_from_yaw
from semmap.schemas.replies import LoggedCommit
from tests.extern.web.views.sample_maps import SAID, place, thing


def room(name, at, size, yaw=0.0):
    where = Pose(position_m=at, orientation_wxyz=orientation_from_yaw(yaw))
    return structs.replace(place(name, size), pose=where)


KITCHEN = room("kitchen1", (2.0, 0.0, 0.0), (2.0, 2.0, 2.5))
STUDIO = room("studio1", (-2.0, 0.0, 0.0), (2.0, 2.0, 2.5))
FLAT = room("flat1", (0.0, 0.0, 0.0), (10.0, 8.0, 2.5))
PLACES = (KITCHEN, STUDIO, FLAT)


def pose(x, y=0.0, z=0.0):
    return Pose(position_m=(x, y, z))


def logged(seq, *changes, **fields):
    return LoggedCommit(
        seq=seq, stamp_ns=seq * 1_000_000_000, source="operator", agent="bob", verb="update",
        reason="tidy up", confidence=fields.pop("confidence", None), undoes=(), tbox=False,
        inserted=1, retracted=1,
        changed=("cup1",), changes=changes, removed=fields.pop("removed", ()), **fields
    )  # fmt: skip


def moved(was, now):
    return Change(name="cup1", kind="pose", was=was, now=now)


def texts(*changes, **fields):
    (event,) = history_events("cup1", [logged(3, *changes, **fields)], PLACES)
    return event.texts


def test_moves_have_places_and_distance():
    assert texts(moved(pose(2.0), pose(-2.0))) == (
        "moved from (2, 0, 0) to (-2, 0, 0) (4.00 m, from kitchen1 to studio1)",
    )
    assert texts(moved(pose(2.0), pose(2.25))) == (
        "moved from (2, 0, 0) to (2.25, 0, 0) (25 cm, within kitchen1)",
    )
    assert texts(moved(pose(2.0), pose(20.0))) == (
        "moved from (2, 0, 0) to (20, 0, 0) (18.00 m, from kitchen1)",
    )


def test_rotations_and_first_poses_have_no_distance():
    turned = Pose(position_m=(2.0, 0.0, 0.0), orientation_wxyz=orientation_from_yaw(math.pi / 2))
    assert texts(moved(pose(2.0), turned)) == ("turned from 0° to 90°",)
    assert texts(moved(None, pose(2.0))) == ("placed at (2, 0, 0)",)


def test_only_changes_of_the_entity_are_listed():
    other = Change(name="cup2", kind="added", now="Cup")
    assert texts(other, Change(name="cup1", kind="reference", was="cup", now="mug")) == (
        "label: 'cup' → 'mug'",
    )
    assert texts(other) == ("changed, with many others",)
    assert texts(removed=("cup1",)) == ("removed",)
    renamed = Change(name="mug1", kind="name", was="cup1", now="mug1")
    assert texts(renamed, removed=("cup1",)) == ("renamed to mug1",)


def test_the_newest_event_is_first_with_author_and_reason():
    first, second = history_events("cup1", [logged(3), logged(4, confidence=0.5)], PLACES)
    assert (first.commit, second.commit) == (4, 3)
    assert (first.by, first.reason, first.confidence) == ("operator/bob", "tidy up", "0.50")


@pytest.mark.parametrize(
    ("x", "y", "found"), [(2.0, 0.9, "kitchen1"), (0.0, 0.0, "flat1"), (2.0, 1.1, "flat1"), (50.0, 0.0, "")]
)
def test_a_position_is_in_the_smallest_place_that_contains_it(x, y, found):
    assert find_place(pose(x, y), PLACES) == found


def test_places_can_be_rotated():
    turned = room("a", (0.0, 0.0, 0.0), (4.0, 1.0, 2.0), math.pi / 2)
    assert find_place(pose(0.0, 1.9), [turned]) == "a"
    assert find_place(pose(1.9, 0.0), [turned]) == ""


def test_equal_provenance_is_listed_once():
    assert len(group_provenance(thing("cup1"))) == 1
    later = Provenance(commit=4, stamp_ns=2_000_000_000, source="perception", reason="seen", confidence=0.9)
    told = group_provenance(structs.replace(thing("cup1"), pose_provenance=later, provenance=later))
    assert list(told) == ["pose, last change", "class and size, labels"]
    assert "confidence 0.90" in told["pose, last change"]
    assert SAID.reason in told["class and size, labels"]
