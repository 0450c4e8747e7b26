"""Segments hold the points of their labels, in the map's frame."""

from __future__ import annotations

import numpy as np

from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.views.segments import MOST_POINTS, cut_out, in_map, map_points
from tests.perception_node.segmentation.scenes import camera_pose

POSE = camera_pose()
RNG = np.random.default_rng(0)
CLOUD = Cloud(
    RNG.uniform(0.5, 2.0, (120, 160, 3)).astype(np.float32),
    RNG.integers(0, 256, (120, 160, 3), dtype=np.uint8),
    POSE,
)
LABELS = np.zeros((120, 160), np.int32)
LABELS[:100, 40:120] = 2  # which touches the picture's edge, and has more points than are kept
LABELS[105:110, 50:60] = 5


def test_a_part_of_the_cloud_lies_in_the_map_where_the_whole_has_it():
    whole = map_points(CLOUD, POSE)
    np.testing.assert_array_equal(in_map(CLOUD.points_camera[3:7, ::5], POSE), whole[3:7, ::5])
    ends = np.append(CLOUD.points_camera[4, 4], 1.0)
    np.testing.assert_allclose(whole[4, 4], (POSE @ ends)[:3], atol=1e-5)


def test_each_label_is_a_segment_with_its_points_and_colours():
    large, small = cut_out(CLOUD, POSE, LABELS, frozenset({5}))
    assert (large.label, small.label) == (2, 5)
    assert (large.cut, small.cut) == (True, False)
    assert (large.carrier, small.carrier) == (False, True)
    assert (large.count, small.count) == (8000, 50)
    assert 0.5 * MOST_POINTS < len(large.points) <= MOST_POINTS
    np.testing.assert_array_equal(small.points, map_points(CLOUD, POSE)[LABELS == 5])
    np.testing.assert_array_equal(small.colors, CLOUD.colors[LABELS == 5])
    np.testing.assert_array_equal(small.eye, POSE[:3, 3])


def test_one_point_seen_again_and_again_is_no_segment():
    still = Cloud(np.ones((120, 160, 3), np.float32))
    assert cut_out(still, POSE, LABELS) == []
    assert cut_out(CLOUD, POSE, np.zeros_like(LABELS)) == []
