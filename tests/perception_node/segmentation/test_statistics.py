"""Sums of a union are the sums of its parts."""

from __future__ import annotations

import numpy as np
import pytest

from nodes.perception_node.segmentation import statistics as s
from nodes.perception_node.segmentation.pairs import NAMES, candidates, features
from tests.perception_node.segmentation.scenes import boxes_on_table
from tests.perception_node.segmentation.taken_apart import apart

POINTS = np.ones((3, 30, 40), np.float32)
POINTS[1], POINTS[0] = np.mgrid[0:30, 0:40] * 0.01
POINTS[2, 10:20, 30:] -= 0.2
NORMALS = np.broadcast_to(np.float32([[[0]], [[0]], [[-1]]]), POINTS.shape)
LABELS = np.zeros((30, 40), np.int32)
LABELS[:10, :30], LABELS[10:20, :30], LABELS[20:, :30], LABELS[10:20, 30:] = 1, 2, 3, 4
UPRIGHT = s.Upright(np.eye(3), np.zeros(1))


def of(labels):
    return s.statistics(labels, POINTS, NORMALS, np.full_like(POINTS, np.nan), UPRIGHT)


def test_colours_are_compared_where_there_are_any():
    shades = np.zeros_like(POINTS)
    shades[:, LABELS == 2] = [[0.5], [0.3], [0.4]]
    known = s.statistics(LABELS, POINTS, NORMALS, shades, UPRIGHT)
    first, second = np.array([0, 0, 0]), np.array([1, 2, 3])
    rows = features(known, first, second)
    coloured, there = NAMES.index("coloured"), NAMES.index("coloured_there")
    np.testing.assert_allclose(rows[:, coloured], [0.5, 0.0, 0.0], atol=1e-6)
    np.testing.assert_allclose(rows[:, there], [0.5, -1.0, -1.0], atol=1e-6)
    np.testing.assert_array_equal(features(of(LABELS), first, second)[:, [coloured, there]], -1.0)


def test_counts_bounds_and_borders():
    known = of(LABELS)
    np.testing.assert_array_equal(known.inside[:, s.COUNT], [300, 300, 300, 100])
    np.testing.assert_allclose(known.low[1], [0.0, 0.1, 1.0], atol=1e-6)
    np.testing.assert_allclose(known.high[1], [0.29, 0.19, 1.0], atol=1e-6)
    assert known.between[0, 1, s.TOUCH] == 30
    assert known.between[1, 3, s.TOUCH] == known.between[1, 3, s.STEP] == 10
    assert known.between[3, 1, s.BEFORE] == 10
    assert known.between[1, 3, s.BEFORE] == 0
    assert known.between[0, 2, s.SIGHT] > 0
    assert known.inside[1, s.HIDDEN] == 10


def test_a_merged_patch_has_the_sums_of_both():
    known, merged = of(LABELS), of(np.where(LABELS == 2, 1, np.where(LABELS > 2, LABELS - 1, LABELS)))
    known.merge(0, 1)
    rest = [0, 2, 3]
    np.testing.assert_allclose(known.inside[rest], merged.inside)
    np.testing.assert_allclose(known.low[rest], merged.low)
    np.testing.assert_allclose(known.high[rest], merged.high)
    borders = [s.TOUCH, s.STEP, s.BEFORE, s.WIDE, s.BENDS, s.BEND, s.CONCAVE, s.LIKE]
    for a, b in ((0, 1), (1, 0), (0, 2), (2, 0), (1, 2)):
        np.testing.assert_allclose(known.between[rest[a], rest[b]][borders], merged.between[a, b][borders])
    assert known.owner.tolist() == [0, 0, 2, 3]


def test_a_copy_is_independent():
    known = of(LABELS)
    before = known.copy()
    known.merge(0, 1)
    assert before.inside[0, s.COUNT] == 300


@pytest.fixture(scope="module")
def occluded():
    return apart(boxes_on_table(((-0.2, 0.05, 0), (0.2, 0.1, 0.1)), ((-0.03, -0.1, 0), (0.03, -0.05, 0.25))))


def test_features_do_not_depend_on_the_order(occluded):
    known = occluded[0].statistics
    a, b = np.nonzero(np.triu(candidates(known)))
    rows = features(known, a, b)
    assert rows.shape == (len(a), len(NAMES))
    assert np.isfinite(rows).all()
    np.testing.assert_array_equal(rows, features(known, b, a))


def test_what_is_parted_by_something_in_front_may_be_one(occluded):
    parts, owner = occluded
    middles = parts.statistics.inside[:, s.POINT][:, 0] / parts.statistics.inside[:, s.COUNT]
    left, right = (np.flatnonzero((owner == 1) & side) for side in (middles < 0, middles > 0))
    assert left.size
    assert right.size
    assert candidates(parts.statistics)[np.ix_(left, right)].any()
