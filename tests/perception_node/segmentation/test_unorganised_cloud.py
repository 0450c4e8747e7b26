"""Unorganised clouds."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.segmentation.unorganised_cloud import as_image, fill_holes
from semmap.nodes.perception_node.views.segmented_view import segment_cloud
from tests.perception_node.segmentation.scenes import boxes_on_table, camera_pose

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
    points = [[0, 0, 1], [0.01, 0, 1], [0, 0.01, 1], [0, 0, -1], [0, 0, 0], [0.1, 0.1, 0], [np.nan] * 3]
    _, pixel = as_image(Cloud(np.array([points], np.float32)))
    assert (pixel >= 0).tolist() == [True] * 3 + [False] * 4


def test_nothing_seen():
    cloud = replace(SEEN.cloud, points_camera=np.full((1, 5, 3), np.nan, np.float32))
    picture, pixel = as_image(cloud)
    assert picture.organised
    assert (pixel == -1).all()


def thinned_to_voxels(points, side_m=0.005):
    """Return the mean of the points (N, 3) in each voxel."""
    voxels, of = np.unique(np.floor(points / side_m).astype(int), axis=0, return_inverse=True)
    sums = np.zeros((len(voxels), 3))
    np.add.at(sums, of, points)
    return (sums / np.bincount(of)[:, None]).astype(np.float32)


@pytest.mark.parametrize("height_m", [0.2, 0.45, 0.75, 1.1])
def test_a_box_is_found_on_a_table_of_any_height_in_a_cloud_of_voxels(height_m):
    table = ((-0.5, -0.35, height_m - 0.04), (0.5, 0.35, height_m))
    box = ((-0.1, -0.1, height_m), (0.05, 0.0, height_m + 0.15))
    pose = camera_pose((0.2, -1.1, height_m + 0.65), (0.0, 0.0, height_m))
    seen = boxes_on_table(table, box, pose=pose, table=((-3, -3, -0.05), (3, 3, 0)))
    points = seen.cloud.points_camera.reshape(-1, 3)
    found = segment_cloud(Cloud(thinned_to_voxels(points[np.isfinite(points[:, 2])])[None]))
    things = [segment for segment in found.segments if not segment.carrier]
    tops = [round(float(np.quantile(s.points[:, 2], 0.95)), 2) for s in things if len(s.points) > 200]
    assert height_m + 0.15 == pytest.approx(min(tops, key=lambda top: abs(top - height_m - 0.15)), abs=0.02)
    assert max(support.height_m for support in found.supports) == pytest.approx(height_m, abs=0.02)


def test_holes_in_a_surface_are_filled_and_edges_are_not_moved():
    image = np.full((6, 6, 3), np.nan, np.float32)
    image[:, 2:] = (0.0, 0.0, 1.0)
    image[3, 3] = np.nan
    colors = np.full((6, 6, 3), 90, np.uint8)
    colors[3, 3] = 0
    fill_holes(image, colors)
    assert image[3, 3].tolist() == [0.0, 0.0, 1.0]
    assert colors[3, 3].tolist() == [90, 90, 90]
    assert np.isnan(image[:, :2]).all()


def flat_grid(begin, end, pitch, depth_m=2.0):
    """Return points (N, 3) on a wall, in rays at this pitch from the corner `begin` to `end`."""
    u, v = np.meshgrid(*(np.arange(a, b, pitch) + pitch / 2 for a, b in zip(begin, end, strict=True)))
    return np.stack([u.ravel(), v.ravel(), np.ones(u.size)], axis=-1) * depth_m


@pytest.mark.parametrize(("sparse", "pitch"), [(0.0, 0.004), (0.1, 0.004), (0.4, 0.008)])
def test_the_image_is_as_dense_as_most_of_the_view(sparse, pitch):
    border = 0.64 * sparse
    dense = flat_grid((border, 0.0), (0.64, 0.64), 0.004)
    points = np.concatenate([dense, flat_grid((0.0, 0.0), (border, 0.64), 0.008)])
    image, _ = as_image(Cloud(points[None].astype(np.float32)))
    assert image.points_camera.shape[:2] == pytest.approx((0.64 / pitch, 0.64 / pitch), abs=2)


def test_a_pixel_has_the_mean_of_its_points_on_the_nearest_surface():
    points = flat_grid((0.0, 0.0), (0.48, 0.48), 0.02)
    count, one = len(points), 250
    ray = points[one] / 2.0
    points = np.concatenate([points, np.outer([2.02, 2.04, 2.5], ray)])
    colors = np.full(points.shape, 100, np.uint8)
    colors[count:] = [[110] * 3, [200] * 3, [200] * 3]
    image, pixel = as_image(Cloud(points[None].astype(np.float32), colors[None]))
    assert (pixel[count:] == pixel[one]).all()
    points[one], colors[one] = 2.01 * ray, 105
    np.testing.assert_allclose(image.points_camera.reshape(-1, 3)[pixel[:count]], points[:count], rtol=1e-5)
    np.testing.assert_array_equal(image.colors.reshape(-1, 3)[pixel[:count]], colors[:count])


@pytest.mark.parametrize(
    ("around", "depth", "shade"),
    [
        ([1.0] * 8, 1.0, 35),
        ([1.01, 1.0, 1.0, 1.0, 0, 0, 0, 0], 1.0025, 15),
        ([1.0, 1.0, 1.0, 0, 0, 0, 0, 0], None, 0),
        ([1.0, 1.0, 1.0, 1.02, 0, 0, 0, 0], None, 0),
        ([1.0, 1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 2.0], 1.0, 15),
    ],
)
def test_a_hole_is_filled_if_four_neighbours_are_on_one_surface(around, depth, shade):
    """The neighbours have the shades 0, 10, 20 and so on, row by row."""
    points = np.full((3, 3, 3), np.nan, np.float32)
    colors = np.zeros((3, 3, 3), np.uint8)
    places = [(0, 0), (0, 1), (0, 2), (1, 0), (1, 2), (2, 0), (2, 1), (2, 2)]
    for number, ((row, column), z) in enumerate(zip(places, around, strict=True)):
        colors[row, column] = 10 * number
        if z:
            points[row, column] = (0.1 * z, 0.2 * z, z)
    fill_holes(points, colors)
    middle = points[1, 1].tolist()
    if depth is None:
        assert np.isnan(middle).all()
    else:
        assert middle == pytest.approx([0.1 * depth, 0.2 * depth, depth])
    assert colors[1, 1].tolist() == [shade] * 3
