"""Dominant planes."""

from __future__ import annotations

import numpy as np
import pytest

from nodes.perception_node.segmentation.grid import grid_of
from nodes.perception_node.segmentation.planes import find_planes
from tests.perception_node.segmentation.scenes import boxes_on_table, camera_pose

BOX = ((-0.1, -0.1, 0.0), (0.1, 0.1, 0.2))


@pytest.mark.parametrize("seed", range(20))
def test_the_table_is_found_where_nobody_knows_what_is_up(seed):
    seen = boxes_on_table(BOX)
    planes, of_plane = find_planes(grid_of(seen.cloud).points, None, np.random.default_rng(seed))
    assert [plane.kind for plane in planes] == ["support"]
    pose = camera_pose()
    np.testing.assert_allclose(planes[0].normal, pose[2, :3], atol=0.01)
    assert planes[0].offset_m == pytest.approx(-pose[2, 3], abs=0.005)
    assert (
        (of_plane == 1) == ((seen.truth[::2, ::2] == 0) & np.isfinite(seen.cloud.points_camera[::2, ::2, 2]))
    ).mean() > 0.95


def test_floor_support_and_wall_are_told_apart():
    pose = camera_pose(eye=(0.0, -2.0, 1.7), target=(0.0, 0.3, 0.7))
    floor = ((-3, -3, -0.1), (3, 3, 0.0))
    table = ((-0.6, -0.5, 0.70), (0.6, 0.5, 0.75))
    wall = ((-3, 1.5, 0.0), (3, 1.6, 2.5))
    seen = boxes_on_table(table, wall, pose=pose, posed=True, table=floor)
    planes, of_plane = find_planes(
        grid_of(seen.cloud).points, seen.cloud.map_from_camera, np.random.default_rng(0)
    )
    kinds = {plane.kind: n for n, plane in enumerate(planes, 1)}
    assert set(kinds) == {"floor", "support", "wall"}
    truth = seen.truth[::2, ::2]
    assert (truth[of_plane == kinds["wall"]] == 2).mean() > 0.95
    assert (truth[of_plane == kinds["support"]] == 1).mean() > 0.95


@pytest.mark.parametrize("points", [np.full((8, 8, 3), np.nan), np.ones((8, 8, 3)), np.zeros((40, 40, 3))])
def test_no_plane_in_what_has_none(points):
    planes, of_plane = find_planes(points.astype(np.float32), None, np.random.default_rng(0))
    assert planes == ()
    assert not of_plane.any()
