import math

import pytest

from semmap.nodes.extern.ros import messages
from tests.extern.ros.made import AT, thing


def test_a_detection_is_the_box_around_the_middle():
    (found,) = messages.detections([thing(yaw=math.pi / 2, probability=0.5)], AT).detections
    assert (found.id, found.header.frame_id) == ("cup1", "map")
    assert (found.header.stamp.sec, found.header.stamp.nanosec) == (1, 500_000_002)
    assert found.bbox.center.position.z == pytest.approx(0.75)
    assert found.bbox.center.orientation.z == pytest.approx(math.sqrt(0.5))
    (hypothesis,) = found.results
    assert (hypothesis.hypothesis.class_id, hypothesis.hypothesis.score) == ("Cup", 0.5)


def test_a_place_is_not_a_detection_and_has_a_name_and_a_frame():
    room = thing("kitchen1", "Kitchen", place=True, size_m=(3.0, 3.0, 2.5))
    assert messages.detections([room], AT).detections == []
    assert [m.text for m in messages.markers([room], AT).markers] == ["", "kitchen1"]
    (frame,) = messages.transforms([room], AT).transforms
    assert (frame.header.frame_id, frame.child_frame_id) == ("map", "kitchen1")


def test_markers_begin_by_deleting_all_and_no_two_have_one_number():
    drawn = messages.markers([thing("a"), thing("b")], AT).markers
    assert drawn[0].action == 3
    assert len({(m.ns, m.id) for m in drawn[1:]}) == len(drawn) - 1 == 4
