"""Clouds in the frame of a map or robot."""

from __future__ import annotations

import numpy as np
import pytest

from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.input.viewpoint import Placement, find_up, hidden, is_seen_from_origin
from semmap.nodes.perception_node.views.segments import map_points
from tests.perception_node.segmentation.scenes import boxes_on_table, camera_pose
from tests.perception_node.segmentation.test_patches import SCENES

EYE = (0.3, -0.8, 0.6)
TO_UP = {  # coordinates of the file from those of a frame whose z is up
    "x": lambda p: np.stack([p[..., 2], p[..., 1], -p[..., 0]], axis=-1),
    "y": lambda p: np.stack([p[..., 0], p[..., 2], -p[..., 1]], axis=-1),
    "z": lambda p: p,
}


@pytest.fixture(scope="module")
def scene():
    """Return a cloud of a small picture and its points in the map frame."""
    whole = boxes_on_table(*SCENES["apart"], pose=camera_pose(EYE), posed=True).cloud
    cloud = Cloud(whole.points_camera[::3, ::3], map_from_camera=whole.map_from_camera)
    return cloud, map_points(cloud, cloud.map_from_camera)


@pytest.mark.parametrize("up", TO_UP)
def test_the_camera_of_an_organised_cloud_is_found(scene, up):
    cloud, points = scene
    placed, pose = Placement(up).place(TO_UP[up](points))
    assert pose == pytest.approx(cloud.map_from_camera, abs=2e-3)
    assert placed == pytest.approx(cloud.points_camera, abs=2e-3, nan_ok=True)


@pytest.mark.parametrize("up", TO_UP)
def test_a_cloud_without_order_is_seen_from_a_place_where_little_is_hidden(scene, up):
    _, points = scene
    points = points.reshape(-1, 3)
    points = np.random.default_rng(0).permutation(points[np.isfinite(points[:, 2])])
    placed, pose = Placement(up).place(TO_UP[up](points[None]))
    assert (placed[..., 2] > 0).mean() > 0.99
    assert pose[2, 3] > 0.2
    assert pose[1, 3] < 0.0  # the sides that were seen face the camera
    again = placed[0] @ pose[:3, :3].T + pose[:3, 3]
    assert again == pytest.approx(points, abs=1e-4)


def test_a_pose_in_the_frame_of_the_cloud_is_used(scene):
    cloud, points = scene
    placed, pose = Placement("z", cloud.map_from_camera).place(points)
    assert pose == pytest.approx(cloud.map_from_camera)
    assert placed == pytest.approx(cloud.points_camera, abs=1e-4, nan_ok=True)


def test_a_floor_below_the_frame_becomes_zero(scene):
    _, points = scene
    sensor = points - np.float32([0.0, 0.0, 1.2])
    placed, pose = Placement("z").place(sensor)
    again = placed.reshape(-1, 3) @ pose[:3, :3].T + pose[:3, 3]
    assert again == pytest.approx(points.reshape(-1, 3), abs=0.01, nan_ok=True)


@pytest.mark.parametrize("value", [np.nan, 0.0, 1.0])
@pytest.mark.parametrize("shape", [(1, 1), (1, 50), (20, 30)])
def test_clouds_with_nothing_in_them_are_no_trouble(shape, value):
    placed, pose = Placement("z").place(np.full((*shape, 3), value, np.float32))
    assert placed.shape == (*shape, 3)
    assert np.isfinite(pose).all()


@pytest.mark.parametrize("far", [1e9, 1e30])
def test_a_point_far_away_does_not_prevent_the_rest(scene, far):
    _, points = scene
    points = points.copy()
    points[0, 0] = far
    placed, pose = Placement("z").place(points)
    assert np.isfinite(pose).all()
    assert (placed[np.isfinite(placed[..., 2]), 2] > 0).mean() > 0.9


@pytest.mark.parametrize("up", TO_UP)
def test_the_vertical_is_found_of_points_that_no_camera_at_the_origin_can_have_seen(scene, up):
    cloud, points = scene
    assert is_seen_from_origin(cloud.points_camera.reshape(-1, 3))
    found = TO_UP[up](points).reshape(-1, 3) + np.float32([0.0, 0.0, 0.01])
    assert not is_seen_from_origin(found)
    assert find_up(found) == (up, False)
    assert find_up(-found) == (up, True)


def test_points_without_a_level_have_no_vertical():
    assert find_up(np.random.default_rng(0).normal(size=(5000, 3)).astype(np.float32)) is None
    assert find_up(np.zeros((5, 3), np.float32)) is None


def test_points_without_a_measurement_say_nothing_of_the_vertical(scene):
    cloud, points = scene
    seen = points.reshape(-1, 3) + np.float32([0.0, 0.0, 0.01])
    nothing = np.concatenate([np.zeros_like(seen), np.full_like(seen, np.nan)])
    assert find_up(np.concatenate([nothing, seen])) == ("z", False)
    assert not is_seen_from_origin(np.concatenate([nothing, seen]))
    assert is_seen_from_origin(np.concatenate([nothing, cloud.points_camera.reshape(-1, 3)]))


@pytest.mark.parametrize(
    ("point", "is_hidden"),
    [
        ((0.0, 0.0, 1.02), False),
        ((0.0, 0.0, 1.05), True),
        ((0.0, 0.0, 0.5), False),
        ((0.0, 0.0, 0.04), True),
        ((0.0, 0.0, -1.0), True),
        ((1.4, 0.0, 1.0), False),
        ((1.6, 0.0, 1.0), True),
        ((0.0, -1.6, 1.0), True),
    ],
)
def test_a_point_is_hidden_behind_another_or_outside_the_view(point, is_hidden):
    """A camera 2 m along the map's x axis sees a flat square of points in which the point lies."""
    pose = np.eye(4)
    pose[0, 3] = 2.0
    grid = np.stack([*np.meshgrid(*[np.linspace(-1.0, 1.0, 31)] * 2), np.ones((31, 31))], axis=-1)
    points = np.concatenate([grid.reshape(-1, 3), [point]]) + pose[:3, 3]
    covers = 1 if point[2] == 0.5 else 0
    assert hidden(points, pose) * len(points) == pytest.approx(is_hidden + covers)


def test_all_points_are_hidden_from_a_camera_that_looks_away():
    assert hidden(np.array([[0.0, 0.0, -1.0], [0.0, 0.1, -2.0]]), np.eye(4)) == 1.0


@pytest.mark.parametrize(
    ("up", "axis"),
    [
        ("x", (1, 0, 0)),
        ("y", (0, 1, 0)),
        ("z", (0, 0, 1)),
        (None, (0, 0, 1)),
        ("-x", (-1, 0, 0)),
        ("-y", (0, -1, 0)),
        ("-z", (0, 0, -1)),
    ],
)
def test_the_axis_that_is_up_becomes_z_and_nothing_is_mirrored(up, axis):
    turned = [Placement(up).place(np.float32([[one]]))[0][0, 0] for one in (axis, *np.eye(3))]
    assert turned[0].tolist() == [0, 0, 1]
    assert np.linalg.det(turned[1:]) == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("levels_m", "lift_m"),
    [
        ({-1.0: 100, 0.5: 100}, 1.0),
        ({-1.0: 100, -3.0: 2}, 1.0),
        ({-1.0: 100, -3.0: 10}, 3.0),
        ({-0.04: 100}, 0.0),
        ({0.5: 100, 1.0: 5}, 0.0),
        ({-1.01: 40, -0.99: 60}, 0.99),
    ],
)
def test_the_lowest_level_of_many_points_is_lifted_to_zero_if_it_is_below(levels_m, lift_m):
    heights = np.repeat([*levels_m], [*levels_m.values()])
    points = np.stack([np.ones_like(heights), np.zeros_like(heights), heights], axis=-1)
    camera = np.eye(4)
    camera[:3, 3] = (0.1, 0.2, 0.3)
    placed, pose = Placement("z", camera).place(points[None].astype(np.float32))
    assert pose[:3, 3] == pytest.approx((0.1, 0.2, 0.3 + lift_m), abs=0.016)
    assert placed[0] == pytest.approx(points - camera[:3, 3], abs=1e-6)
