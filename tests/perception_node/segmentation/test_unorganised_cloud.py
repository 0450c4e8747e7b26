"""Unorganised clouds."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.segmentation.unorganised_cloud import as_image
from tests.perception_node.segmentation.scenes import boxes_on_table

SEEN = boxes_on_table(((-0.1, -0.1, 0.0), (0.1, 0.1, 0.2)))


def test_the_pixels_of_a_shuffled_picture_are_found_again():
    points = SEEN.cloud.points_camera
    row, column = np.nonzero(np.isfinite(points[..., 2]))
    order = np.random.default_rng(0).permutation(len(row))
    row, column = row[order], column[order]
    picture, pixel = as_image(Cloud(points[row, column][None]))
    found_row, found_column = np.divmod(pixel, picture.points_camera.shape[1])
    assert len(np.unique(row - found_row)) == 1
    assert len(np.unique(column - found_column)) == 1
    np.testing.assert_array_equal(picture.points_camera[found_row, found_column], points[row, column])


def test_colours_go_with_their_points():
    points = SEEN.cloud.points_camera.reshape(-1, 3)
    points = points[np.isfinite(points[:, 2])]
    colors = np.random.default_rng(1).integers(0, 256, points.shape).astype(np.uint8)
    picture, pixel = as_image(Cloud(points[None], colors[None]))
    shown = picture.points_camera.reshape(-1, 3)[pixel] == points
    np.testing.assert_array_equal(picture.colors.reshape(-1, 3)[pixel][shown[:, 2]], colors[shown[:, 2]])


def test_a_thinned_cloud_leaves_few_holes():
    points = SEEN.cloud.points_camera.reshape(-1, 3)
    points = points[np.isfinite(points[:, 2])]
    kept = points[np.random.default_rng(0).random(len(points)) < 0.4]
    picture, pixel = as_image(Cloud(kept[None]))
    assert (pixel >= 0).mean() > 0.99
    assert np.isfinite(picture.points_camera[..., 2]).mean() > 0.4


def test_points_behind_the_camera_fall_on_no_pixel():
    points = np.array([[0, 0, 1], [0.01, 0, 1], [0, 0.01, 1], [0, 0, -1], [np.nan] * 3], np.float32)
    _, pixel = as_image(Cloud(points[None]))
    assert (pixel >= 0).tolist() == [True, True, True, False, False]


def test_nothing_seen():
    cloud = replace(SEEN.cloud, points_camera=np.full((1, 5, 3), np.nan, np.float32))
    picture, pixel = as_image(cloud)
    assert picture.organised
    assert (pixel == -1).all()
