"""Thin things on planes."""

from __future__ import annotations

import numpy as np
import pytest

from semmap.nodes.perception_node.segmentation import segment
from semmap.nodes.perception_node.segmentation.planes import Plane, find_planes
from semmap.nodes.perception_node.segmentation.thin_things import thin_things
from semmap.nodes.perception_node.segmentation.working_image import grid_of
from semmap.nodes.perception_node.views.segmented_view import segment_cloud
from tests.perception_node.segmentation.scenes import boxes_on_table, camera_pose

TABLE = ((-0.6, -0.5, 0.70), (0.6, 0.5, 0.75))
FLOOR = ((-3, -3, -0.1), (3, 3, 0.0))
FAR = {"pose": camera_pose(eye=(0.0, -1.5, 1.9), target=(0.0, 0.0, 0.75)), "posed": True, "table": FLOOR}
RULER = ((-0.15, -0.02, 0.75), (0.15, 0.02, 0.765))
TALL = ((0.25, -0.1, 0.75), (0.4, 0.1, 1.0))


def found(*things):
    seen = boxes_on_table(TABLE, *things, **FAR)
    grid = grid_of(seen.cloud)
    planes, of_plane = find_planes(grid.points, seen.cloud.map_from_camera, np.random.default_rng(0))
    return thin_things(grid.points, planes, of_plane), seen.truth[:: grid.step, :: grid.step]


def test_what_is_thinner_than_a_planes_noise_is_found_from_two_metres():
    thin, truth = found(RULER)
    assert thin.max() == 1
    assert ((thin == 1) & (truth == 2)).sum() > 0.7 * ((thin == 1) | (truth == 2)).sum()


def test_nothing_is_found_on_a_bare_table():
    assert found()[0].max() == 0


def test_the_foot_of_something_tall_is_no_thin_thing():
    thin, truth = found(TALL, RULER)
    assert thin.max() == 1
    assert (thin[truth == 3] == 1).mean() > 0.7
    assert (truth[thin == 1] == 2).mean() < 0.05


def test_a_plane_that_a_camera_bends_has_no_things_on_it():
    seen = boxes_on_table(TABLE, **FAR)
    grid = grid_of(seen.cloud)
    across = np.linspace(-1, 1, grid.points.shape[2], dtype=np.float32)
    points = grid.points * (1 + 0.005 * np.sin(3 * across))
    planes, of_plane = find_planes(points, seen.cloud.map_from_camera, np.random.default_rng(0))
    assert thin_things(points, planes, of_plane).max() == 0


@pytest.mark.parametrize("thing", [pytest.param(RULER, id="ruler"), pytest.param(TALL, id="box")])
def test_a_thing_on_a_top_is_one_segment_and_no_part_of_the_top(thing):
    seen = boxes_on_table(TABLE, thing, **FAR)
    labels = segment(seen.cloud).labels
    own = labels[seen.truth == 2]
    assert (own == np.bincount(own[own > 0]).argmax()).mean() > 0.7
    sight = segment_cloud(seen.cloud)
    label = np.bincount(sight.labels[seen.truth == 2]).argmax()
    assert label not in sight.carriers


PITCH_M = 0.01


def islands(*things, away_m=1.0, kinds=("support",), shape=(70, 80)):
    """Return what is found on a plane `away_m` below a camera, given windows (rows, columns, height [m]).

    The cells are of the last of several planes.
    """
    height = np.zeros(shape)
    for rows, columns, high_m in things:
        height[rows, columns] = high_m
    row, column = np.indices(shape) * PITCH_M
    points = np.stack([column, row, away_m - height]).astype(np.float32)
    planes = [Plane(np.array([0.0, 0.0, -1.0]), -away_m, kind, height.size, (0.8, 0.7)) for kind in kinds]
    on = np.abs(height) < max(0.009, 0.006 * away_m**2)
    return thin_things(points, planes, on * np.int32(len(planes)))


def square(side, first=20):
    return slice(first, first + side), slice(first, first + side)


@pytest.mark.parametrize(
    ("side", "high_m", "away_m", "found"),
    [
        (8, 0.0055, 1.0, True),
        (8, 0.003, 1.0, False),
        (8, -0.006, 1.0, False),
        (8, 0.0055, 2.0, False),
        (8, 0.011, 2.0, True),
        (8, 0.012, 1.0, False),
        (7, 0.0055, 1.0, True),
        (6, 0.0055, 1.0, False),
        (4, 0.008, 1.0, False),
    ],
)
def test_an_island_is_higher_than_the_noise_of_a_mean_and_of_enough_cells(side, high_m, away_m, found):
    labels = islands((*square(side), high_m), away_m=away_m)
    own = np.zeros_like(labels)
    own[square(side)] = 1
    np.testing.assert_array_equal(labels, own if found else 0)


@pytest.mark.parametrize(("long", "found"), [(40, True), (60, False)])
def test_an_island_is_shorter_than_half_a_metre(long, found):
    assert islands((slice(20, 28), slice(10, 10 + long), 0.0055)).any() == found


@pytest.mark.parametrize(("tall", "found"), [(1, True), (8, False)])
def test_an_island_beside_higher_cells_is_their_foot(tall, found):
    beside = slice(20, 20 + tall), slice(28, 30), 0.1
    assert islands((*square(8), 0.0055), beside).any() == found


def test_each_island_has_a_number_and_walls_have_none():
    both = (*square(8, 10), 0.0055), (*square(8, 50), 0.0055)
    labels = islands(*both)
    assert {labels[14, 14], labels[54, 54]} == {1, 2}
    assert np.count_nonzero(labels) == 2 * 64
    assert not islands(*both, kinds=("wall",)).any()
    np.testing.assert_array_equal(islands(*both, kinds=("wall", "floor")), labels)


def test_the_hole_of_a_ring_is_a_part_of_it():
    ring = (*square(20), 0.0055), (*square(4, 28), 0.0)
    assert islands(*ring)[21:39, 21:39].all()
