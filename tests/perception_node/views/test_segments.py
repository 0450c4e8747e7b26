"""Segments hold the points of their labels, in the map's frame."""

from __future__ import annotations

import numpy as np

from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.views.segments import ENDS_EVERY, MOST_POINTS, cut_out, in_map, map_points
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


def test_ends_are_points_in_the_two_outermost_rows_and_columns():
    points = map_points(CLOUD, POSE)
    large, small = cut_out(CLOUD, POSE, LABELS)
    np.testing.assert_array_equal(large.ends, points[:2, 40:120].reshape(-1, 3)[::ENDS_EVERY])
    assert small.ends.shape == (0, 3)
    near_corner = np.zeros_like(LABELS)
    near_corner[116:118, 156:158] = 1
    assert not cut_out(CLOUD, POSE, near_corner)[0].cut
    assert cut_out(CLOUD, POSE, np.roll(near_corner, 1, axis=0))[0].cut
    assert cut_out(CLOUD, POSE, np.roll(near_corner, 1, axis=1))[0].cut


def test_one_point_seen_again_and_again_is_no_segment():
    still = Cloud(np.ones((120, 160, 3), np.float32))
    assert cut_out(still, POSE, LABELS) == []
    partly = Cloud(np.where(LABELS[..., None] == 2, np.float32(1.0), CLOUD.points_camera))
    assert [segment.label for segment in cut_out(partly, POSE, LABELS)] == [5]
    assert cut_out(CLOUD, POSE, np.zeros_like(LABELS)) == []
