"""Normals of known surfaces."""

from __future__ import annotations

import numpy as np

from semmap.nodes.perception_node.segmentation.normals import normals
from semmap.nodes.perception_node.segmentation.working_image import grid_of
from tests.perception_node.segmentation.scenes import boxes_on_table, camera_pose

BOX = ((-0.15, -0.1, 0.0), (0.15, 0.1, 0.2))


def inner(mask):
    """Return the image without the cells near its border."""
    for _ in range(4):
        mask = mask & np.roll(mask, 1, 0) & np.roll(mask, -1, 0) & np.roll(mask, 1, 1) & np.roll(mask, -1, 1)
    return mask


def test_normals_look_to_the_camera_and_are_right():
    seen = boxes_on_table(BOX)
    points = grid_of(seen.cloud).points
    found = normals(points, np.isfinite(points[2]))
    truth = seen.truth[::2, ::2]
    pose = camera_pose()
    height = np.tensordot(pose[2, :3], points, 1) + pose[2, 3]
    for where, normal in (
        ((truth == 0) & np.isfinite(height), (0, 0, 1)),
        ((truth == 1) & (height > 0.199), (0, 0, 1)),
        ((truth == 1) & (height < 0.199), (0, -1, 0)),
    ):
        expected = np.array(normal) @ pose[:3, :3]
        cosine = expected @ found[:, inner(where)]
        assert len(cosine) > 50
        assert cosine.min() > np.cos(np.radians(12))  # of noise


def test_normals_only_where_asked_and_where_there_are_neighbours():
    points = grid_of(boxes_on_table(BOX).cloud).points.copy()
    where = np.zeros(points.shape[1:], dtype=bool)
    where[100:110, 100:110] = True
    where[200, 160] = True
    points[:, 198:203, 158:163] = np.nan
    points[:, 200, 160] = (0.0, 0.1, 0.9)
    found = normals(points, where)
    assert np.isfinite(found[:, 100:110, 100:110]).all()
    assert np.isnan(found[:, 200, 160]).all()
    assert np.isfinite(found[0]).sum() == 100
