"""Organised and unorganised clouds."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.input.projection import cloud_of
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


def view_of(depth_m):
    """Return the view of a depth image (H, W) [m] of a level camera whose pose is unknown."""
    intrinsics = np.array([[150.0, 0, 80], [0, 150, 60], [0, 0, 1]])
    return segment_cloud(cloud_of(depth_m.astype(np.float32), None, intrinsics))


def test_a_pose_without_a_level_surface_is_noted():
    rows = (np.arange(120) + 0.5)[:, None] + np.zeros(160)
    floor_m = 150.0 / np.maximum(rows - 60, 1.0)
    noise = np.random.default_rng(0).uniform(0.5, 3.0, (120, 160))
    assert view_of(np.where(floor_m < 5, floor_m, np.nan)).notes == ()
    columns = (np.arange(160) - 79.5)[None, :] + np.zeros((120, 1))
    (tilted,) = view_of(1.5 / (1.0 + columns / 150)).notes
    assert "no level surface is visible" in tilted
    (facing,) = view_of(np.full((120, 160), 1.5)).notes
    assert "as if it looked straight down" in facing
    (unplaced,) = view_of(noise).notes
    assert "no plane is visible" in unplaced


def test_the_notes_of_a_cloud_are_those_of_its_view():
    cloud = replace(shot().clouds[0], notes=("an unusual lens",))
    assert segment_cloud(cloud).notes == ("an unusual lens",)
