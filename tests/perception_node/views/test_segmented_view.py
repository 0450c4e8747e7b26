"""Organised and unorganised clouds."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.views.segmented_view import segment_cloud
from tests.perception_node.scenes import shot


def test_a_cloud_without_order_shows_what_its_picture_shows():
    cloud = replace(shot().clouds[0], map_from_camera=None, intrinsics=None)
    points = cloud.points_camera.reshape(1, -1, 3)
    colors = None if cloud.colors is None else cloud.colors.reshape(1, -1, 3)
    ordered, heap = segment_cloud(cloud), segment_cloud(replace(cloud, points_camera=points, colors=colors))
    assert heap.labels.shape == points.shape[:2]
    assert heap.carriers
    assert len(heap.supports) == len(ordered.supports)
    np.testing.assert_allclose(heap.map_from_camera, ordered.map_from_camera, atol=0.01)
    same = (heap.labels.ravel() > 0) == (ordered.labels.ravel() > 0)
    assert same.mean() > 0.98
    assert len(heap.segments) == len(ordered.segments)
    assert sum(segment.count for segment in heap.segments) == np.count_nonzero(heap.labels)


def test_a_cloud_of_nothing_shows_nothing():
    assert segment_cloud(Cloud(np.full((1, 50, 3), np.nan, np.float32))).segments == ()
