import numpy as np

from semmap.nodes.perception_node.detection.decoding import Candidates
from semmap.nodes.perception_node.detection.selection import overlaps, select


def rows_of(boxes, scores, kinds):
    found = Candidates(np.array(boxes, np.float32), np.array(scores, np.float32), np.array(kinds), 9)
    return select(found, 0.3).tolist()


def test_each_thing_is_kept_once_by_its_best_score():
    near = [(0, 0, 10, 10), (0, 0, 10, 8), (0, 0, 10, 9.5), (20, 0, 30, 10)]
    assert rows_of(near, [0.5, 0.9, 0.4, 0.6], [1, 1, 1, 1]) == [1, 3]


def test_another_class_in_nearly_the_same_box_is_the_same_thing():
    boxes = [(0, 0, 10, 10), (0, 0, 10, 9), (0, 0, 10, 6)]
    assert rows_of(boxes, [0.9, 0.8, 0.7], [1, 2, 2]) == [0, 2]


def test_boxes_without_area_and_values_that_are_no_numbers_are_left_out():
    boxes = [(0, 0, 0, 10), (5, 5, 1, 9), (np.nan, 0, 1, 1), (0, 0, 1, 1)]
    assert rows_of(boxes, [0.9, 0.9, 0.9, np.nan], [1, 1, 1, 1]) == []


def test_an_overlap_is_the_share_of_both_boxes_that_they_have_in_common():
    others = [
        (4, 6, 14, 16),
        (9, 6, 19, 16),
        (4, 12, 14, 20),
        (6, 8, 11, 12),
        (14, 6, 20, 16),
        (20, 30, 40, 50),
    ]
    found = overlaps(np.array((4.0, 6.0, 14.0, 16.0)), np.array(others, float))
    np.testing.assert_allclose(found, [1, 50 / 150, 40 / 140, 20 / 100, 0, 0])
    assert overlaps(np.zeros(4), np.zeros((1, 4))).tolist() == [0.0]
