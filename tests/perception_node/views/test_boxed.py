import numpy as np

from semmap.nodes.perception_node.input.masks import DetectorLabel, Masks
from semmap.nodes.perception_node.views.boxed import segments_in_boxes

CHAIR_SEAT, CHAIR_BACK, CUP, WALL = 1, 2, 3, 4


def scene() -> np.ndarray:
    labels = np.zeros((60, 80), np.int32)
    labels[0:20, 40:80] = WALL
    labels[30:40, 10:30] = CHAIR_SEAT
    labels[10:30, 10:16] = CHAIR_BACK
    labels[24:30, 20:26] = CUP
    return labels


def found(*boxes, scores=()) -> np.ndarray:
    labels = tuple(DetectorLabel("x", score) for score in scores or [0.9] * len(boxes))
    return segments_in_boxes(scene(), Masks(np.zeros((60, 80), np.int32), labels, boxes=boxes))


def test_a_box_stands_for_the_segment_that_fills_it():
    np.testing.assert_array_equal(found((19, 23, 27, 31)) == 1, scene() == CUP)


def test_segments_that_fill_a_box_together_are_one_thing_without_what_stands_on_it():
    np.testing.assert_array_equal(found((9, 9, 31, 41)) == 1, np.isin(scene(), [CHAIR_SEAT, CHAIR_BACK]))


def test_of_a_segment_that_goes_on_outside_only_the_part_in_the_box_counts():
    own = found((40, 0, 60, 20)) == 1
    assert own.sum() == 400
    assert own[:20, 40:60].all()


def test_a_large_surface_below_or_behind_a_box_does_not_count():
    assert not found((50, 2, 60, 12)).any()


def test_a_box_without_a_segment_has_no_pixels():
    assert not found((40, 30, 70, 55)).any()


def test_the_better_score_takes_a_segment():
    assert set(np.unique(found((19, 23, 27, 31), (18, 22, 28, 32), scores=(0.5, 0.8)))) == {0, 2}
