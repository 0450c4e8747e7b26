"""The working image, and labels mapped back to points."""

from __future__ import annotations

import numpy as np
import pytest

from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.segmentation.working_image import grid_of, shades_of, spread
from tests.perception_node.segmentation.scenes import boxes_on_table


def test_cells_hold_the_nearest_surface():
    points = np.ones((480, 640, 3), np.float32)
    points[..., 2] = 2.0
    points[11, 21] = (0.5, 0.5, 1.0)
    points[12, 22] = np.nan
    points[14:16, 24:26] = np.nan
    grid = grid_of(Cloud(points))
    assert grid.points.shape == (3, 240, 320)
    np.testing.assert_allclose(grid.points[:, 5, 10], (0.5, 0.5, 1.0))
    np.testing.assert_allclose(grid.points[:, 6, 11], (1.0, 1.0, 2.0))
    assert np.isnan(grid.points[:, 7, 12]).all()


def test_shades_do_not_change_with_the_light():
    bright = np.array([200, 100, 50], np.uint8)
    one, other = shades_of(bright), shades_of(bright // 2)
    assert one[0] == pytest.approx(2 * other[0], rel=0.01)
    np.testing.assert_allclose(one[1:], other[1:], atol=0.1)
    assert (one[1:] > 0).all()
    np.testing.assert_allclose(shades_of(np.array([0, 0, 0])), 0.0)


def test_a_cell_has_the_colour_of_what_is_in_front():
    points = np.ones((480, 640, 3), np.float32)
    points[..., 2] = 2.0
    points[10, 20, 2] = 1.0
    colors = np.full((480, 640, 3), 100, np.uint8)
    colors[10, 20] = (250, 0, 0)
    where = np.zeros((240, 320), dtype=bool)
    where[5:7, 10] = True
    shades = grid_of(Cloud(points, colors)).shades(where)
    np.testing.assert_allclose(shades[:, 5, 10], shades_of(np.array([250, 0, 0])), atol=1e-6)
    np.testing.assert_allclose(shades[1:, 6, 10], 0.0, atol=1e-6)
    np.testing.assert_array_equal(np.isfinite(shades[0]), where)
    assert np.isnan(grid_of(Cloud(points)).shades(where)).all()


@pytest.mark.parametrize("shape", [(480, 640), (481, 643), (240, 320), (2, 3), (600, 1300)])
def test_labels_come_back_in_the_clouds_shape(shape):
    points = np.random.default_rng(0).uniform(1, 2, (*shape, 3)).astype(np.float32)
    points[0, 0] = np.nan
    grid = grid_of(Cloud(points))
    labels = spread(grid, np.ones(grid.points.shape[1:], np.int32))
    assert labels.shape == shape
    assert labels[0, 0] == 0
    assert labels.sum() == shape[0] * shape[1] - 1


def test_pixels_at_borders_go_to_their_own_surface():
    seen = boxes_on_table(((-0.1, -0.3, 0.0), (0.1, -0.2, 0.25)))
    grid = grid_of(seen.cloud)
    rows, columns = (np.arange(n) * grid.step for n in grid.points.shape[1:])
    z = grid.points[2]
    own = seen.cloud.points_camera[..., 2]
    # each cell has the label of that pixel of its four which is on the cell's surface
    labels = np.zeros(z.shape, np.int32)
    for r in (0, 1):
        for c in (0, 1):
            here = np.ix_(rows + r, columns + c)
            labels = np.where(np.abs(own[here] - z) < 0.01, seen.truth[here], labels)
    wrong = (spread(grid, labels) != seen.truth) & np.isfinite(own)
    assert wrong.mean() < 0.002
