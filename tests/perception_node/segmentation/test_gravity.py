"""The vertical and the floor in images of rooms with unknown camera poses."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from semmap.nodes.perception_node.pipeline import observe_clouds
from semmap.nodes.perception_node.recognition.recognition_model import shipped
from semmap.nodes.perception_node.segmentation.gravity import (
    doubt_vertical,
    level_plane,
    room_pose,
    standing_on,
)
from semmap.nodes.perception_node.segmentation.planes import Plane
from semmap.nodes.perception_node.segmentation.working_image import grid_of
from semmap.nodes.perception_node.views.segmented_view import segment_cloud
from tests.perception_node.scenes import KINDS, shot
from tests.perception_node.segmentation.scenes import boxes_on_table, camera_pose
from tests.perception_node.segmentation.test_patches import SCENES


@pytest.mark.parametrize("view", [0, 1])
def test_the_floor_tells_how_a_camera_stands(view):
    cloud = shot().clouds[view]
    pose = room_pose(grid_of(cloud).points)
    assert pose[2, :3] == pytest.approx(cloud.map_from_camera[2, :3], abs=0.01)
    assert pose[2, 3] == pytest.approx(cloud.map_from_camera[2, 3], abs=0.02)
    assert np.linalg.det(pose[:3, :3]) == pytest.approx(1.0)


@pytest.mark.parametrize("view", [0, 1])
def test_without_a_pose_the_same_things_are_found_at_the_same_height(view):
    cloud = shot().clouds[view]
    known = observe_clouds([cloud], shipped()).observations.observations
    found = observe_clouds([replace(cloud, map_from_camera=None)], shipped()).observations.observations
    likeliest = [
        sorted(max(o.candidates, key=o.candidates.__getitem__) for o in seen) for seen in (found, known)
    ]
    assert likeliest[0] == likeliest[1]
    heights = [sorted(o.pose.position_m[2] for o in seen) for seen in (found, known)]
    assert heights[0] == pytest.approx(heights[1], abs=0.02)
    assert len(found) > len(KINDS)  # and the table


def likeliest(observation):
    return max(observation.candidates, key=observation.candidates.__getitem__)


def test_a_table_top_alone_tells_no_height():
    seen = boxes_on_table(*SCENES["apart"])
    assert room_pose(grid_of(seen.cloud).points) is None
    (support,) = segment_cloud(seen.cloud).supports
    assert support.height_m == pytest.approx(0.0, abs=0.01)


def plane(normal, points):
    return Plane(np.array(normal), -1.0, "plane", points, (1.0, 1.0))


def test_a_wall_is_not_the_floor_however_large():
    wall, floor = plane((0.0, 0.5, -0.87), 5000), plane((0.0, -0.87, -0.5), 1000)
    assert level_plane((wall, floor)) is floor
    assert level_plane((wall,)) is None
    assert level_plane(()) is None
    straight_down = plane((0.0, 0.0, -1.0), 10)
    assert level_plane((straight_down,)) is straight_down


@pytest.mark.parametrize("height_m", [0.2, 0.3, 0.45, 0.49, 0.75])
def test_a_table_of_any_height_stands_on_the_floor(height_m):
    table = ((-0.5, -0.35, height_m - 0.04), (0.5, 0.35, height_m))
    box = ((-0.1, -0.1, height_m), (0.0, 0.0, height_m + 0.15))
    pose = camera_pose((0.2, -1.1, height_m + 0.65), (0.0, 0.0, height_m))
    seen = boxes_on_table(table, box, pose=pose, table=((-3, -3, -0.05), (3, 3, 0)))
    found = room_pose(grid_of(seen.cloud).points)
    assert found is not None
    assert found[2, 3] == pytest.approx(pose[2, 3], abs=0.02)


def test_a_small_high_table_is_no_thing_and_carries_things():
    table = ((-0.22, -0.14, 0.62), (0.22, 0.14, 0.66))
    boxes = ((-0.15, -0.05, 0.66), (-0.07, 0.03, 0.8)), ((0.02, -0.05, 0.66), (0.12, 0.05, 0.74))
    seen = boxes_on_table(
        table, *boxes, pose=camera_pose((0.1, -0.9, 1.3), (0.0, 0.0, 0.6)), table=((-3, -3, -0.05), (3, 3, 0))
    )
    first, second = (likeliest_label(seen, number) for number in (2, 3))
    assert 0 < first != second > 0


def likeliest_label(seen, number):
    return np.bincount(segment_cloud(seen.cloud).labels[seen.truth == number]).argmax()


@pytest.mark.parametrize("close_box", [False, True])
def test_a_floor_that_is_little_of_the_image_tells_how_a_camera_stands(close_box):
    wall, box = ((-3, 2, 0), (3, 2.1, 3)), ((-0.2, 1.0, 0), (0.1, 1.3, 0.4))
    close = ((0.05, -0.35, 0), (0.8, -0.1, 0.6))
    pose = camera_pose((0.0, -1.0, 0.45), (0.0, 1.5, 0.45 if close_box else 0.8))
    seen = boxes_on_table(
        wall, box, *([close] if close_box else []), pose=pose, table=((-3, -3, -0.05), (3, 3, 0))
    )
    found = room_pose(grid_of(seen.cloud).points)
    assert found[2] == pytest.approx(pose[2], abs=0.02)
    assert likeliest_label(seen, 2) > 0


@pytest.mark.parametrize("down_deg", [0.0, 30.0, 60.0, 90.0])
def test_the_map_stands_on_a_plane_below_the_camera_and_x_points_ahead(down_deg):
    down = np.radians(down_deg)
    floor = Plane(np.array([0.0, -np.cos(down), -np.sin(down)]), -1.5, "floor", 100, (2.0, 2.0))
    forward = [np.cos(down), 0.0, -np.sin(down)]
    expected = np.column_stack([[0.0, -1.0, 0.0], [-np.sin(down), 0.0, -np.cos(down)], forward])
    pose = standing_on(floor)
    np.testing.assert_allclose(pose[:3, :3], expected, atol=1e-9)
    assert pose[:, 3].tolist() == [0.0, 0.0, 1.5, 1.0]


@pytest.mark.parametrize(
    ("up", "doubt"),
    [
        ((0.0, -1.0, 0.0), ""),
        ((0.0, -0.3, -0.95), ""),
        ((0.0, 0.0, -1.0), "z points at the camera"),
        ((0.0, 0.0, 1.0), "no plane is visible"),
        ((0.0, 0.6, -0.8), "no level surface is visible"),
        ((1.0, 0.0, 0.0), "no level surface is visible"),
    ],
)
def test_a_vertical_is_in_doubt_unless_it_points_up_in_the_image(up, doubt):
    pose = np.eye(4)
    pose[2, :3] = up
    told = doubt_vertical(pose)
    assert told.split(",")[0].split(" is visible")[0] == doubt.split(" is visible")[0]
    assert ("state the camera's pose" in told) == bool(doubt)
