"""Values that are probably mistakes."""

import pytest

from semmap.nodes.coordinator.commands.plausibility import (
    find_doubts,
    find_isolation,
    require_same_nature,
)
from semmap.schemas import errors
from semmap.schemas.entities import ClassInfo, Entity, Pose, Provenance, orientation_from_yaw

BY = Provenance(commit=1, stamp_ns=1, source="operator")


def entity(name, *, at=None, size=None, place=False, yaw=0.0):
    said = dict.fromkeys(("provenance", "pose_provenance", "shape_provenance", "reference_provenance"), BY)
    pose = Pose(position_m=at, orientation_wxyz=orientation_from_yaw(yaw)) if at else None
    return Entity(
        name=name, class_="X", iri="urn:x", types=("X",), pose=pose, size_m=size, place=place, **said
    )


def class_info(name, *, place=False, model=""):
    return ClassInfo(
        name=name,
        iri="urn:x",
        parents=(),
        ancestors=(),
        labels={},
        spatial=True,
        place=place,
        fixed=False,
        model=model,
    )


ROOM = entity("room", at=(2.0, 3.0, 0.0), size=(4.0, 1.0, 2.5), place=True, yaw=1.5707963)
ODD = entity("odd", place=True)


@pytest.mark.parametrize(
    ("at", "places", "outside"),
    [
        ((2.0, 4.9, 0.0), [ROOM], False),  # the room is turned by a quarter
        ((3.9, 3.0, 0.0), [ROOM], True),
        ((3.9, 3.0, 0.0), [], False),
        ((3.9, 3.0, 0.0), [ODD], False),
        ((3.9, 3.0, 0.0), [ODD, ROOM], True),
        (None, [ROOM], False),
    ],
)
def test_outside_every_place(at, places, outside):
    pose = Pose(position_m=at) if at else None
    notes = find_doubts("cup1", class_info("Cup"), pose, None, places)
    assert notes == (("cup1 at (3.9, 3) is outside every place of the map",) if outside else ())
    assert find_doubts("hall", class_info("Hall", place=True), pose, None, places) == ()


def test_a_size_ten_times_off():
    chair = class_info("Chair", model="chair")
    (note,) = find_doubts("c", chair, None, (5.0, 5.0, 9.0), ())
    assert note.startswith("5 x 5 x 9 m is far from the usual size of a Chair, 0.")
    assert find_doubts("c", chair, None, (0.01, 0.01, 0.05), ()) != ()
    assert find_doubts("c", chair, None, (0.4, 0.4, 1.2), ()) == ()
    assert find_doubts("c", class_info("Thing", model="no such model"), None, (90.0, 1.0, 1.0), ()) == ()


def test_a_fridge_becomes_a_room_only_if_forced():
    fridge, room = entity("fridge1"), entity("room1", place=True)
    with pytest.raises(
        errors.Refused, match=r"fridge1 is an object \(X\), and as a Hall it would be a place; .*--force"
    ):
        require_same_nature(fridge, class_info("Hall", place=True), force=False)
    with pytest.raises(errors.Refused, match="room1 is a place"):
        require_same_nature(room, class_info("Fridge"), force=False)
    require_same_nature(fridge, class_info("Hall", place=True), force=True)
    require_same_nature(fridge, class_info("Freezer"), force=False)
    require_same_nature(room, None, force=False)


@pytest.mark.parametrize(
    ("at", "others", "note"),
    [
        ((5.0, 0.0, 0.0), [(0.0, 0.0, 0.0)], ()),
        (
            (900.0, 2.0, 0.0),
            [(0.0, 0.0, 0.0), (1.0, 2.0, 0.0)],
            ("cup1 at (900, 2) is 899 m away from the nearest other object",),
        ),
        ((900.0, 2.0, 0.0), [], ()),
    ],
)
def test_a_body_moved_far_away_from_all_others_is_noted(at, others, note):
    poses = [Pose(position_m=other) for other in others]
    assert find_isolation("cup1", Pose(position_m=at), poses) == note
