"""Occupancy by a depth image: a box that is present, gone, or hidden."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.input.projection import cloud_of
from semmap.nodes.perception_node.tracking.occupancy import occupancy_in
from semmap.schemas.entities import Pose, orientation_from_yaw

WIDTH, HEIGHT, FOCAL = 320, 240, 300.0
INTRINSICS = np.array([[FOCAL, 0.0, WIDTH / 2], [0.0, FOCAL, HEIGHT / 2], [0.0, 0.0, 1.0]])
TABLE_Z = 0.7
CUP = (0.08, 0.08, 0.1)


def looking_down(angle_rad=0.7, distance_m=1.2) -> np.ndarray:
    """Return a camera south of and above the table's centre, with its occupancy function."""
    forward = np.array([0.0, np.cos(angle_rad), -np.sin(angle_rad)])
    right = np.array([1.0, 0.0, 0.0])
    pose = np.eye(4)
    pose[:3, :3] = np.column_stack([right, np.cross(forward, right), forward])
    pose[:3, 3] = np.array([0.0, 0.0, TABLE_Z]) - distance_m * forward
    return pose


def picture(boxes=(), pose=None, noise_m=0.0) -> Cloud:
    """Return the depth of an infinite table with unrotated upright boxes (bottom centre, size)."""
    pose = looking_down() if pose is None else pose
    u, v = np.meshgrid(np.arange(WIDTH) + 0.5, np.arange(HEIGHT) + 0.5)
    rays = np.stack([(u - WIDTH / 2) / FOCAL, (v - HEIGHT / 2) / FOCAL, np.ones_like(u)], -1) @ pose[:3, :3].T
    eye = pose[:3, 3]
    depth = np.where(rays[..., 2] < -1e-6, (TABLE_Z - eye[2]) / np.minimum(rays[..., 2], -1e-6), np.inf)
    for bottom, size in boxes:
        low = np.array(bottom) - [size[0] / 2, size[1] / 2, 0.0]
        one, other = (low - eye) / rays, (low + size - eye) / rays
        enter, leave = np.minimum(one, other).max(-1), np.maximum(one, other).min(-1)
        depth = np.where((enter < leave) & (enter > 0), np.minimum(depth, enter), depth)
    depth = depth + np.random.default_rng(0).normal(0.0, noise_m, depth.shape)
    return cloud_of(depth.astype(np.float32), None, INTRINSICS, pose)


def stands(x, y, z=TABLE_Z, yaw=0.0) -> Pose:
    return Pose(position_m=(x, y, z), orientation_wxyz=orientation_from_yaw(yaw))


@pytest.mark.parametrize("noise_m", [0.0, 0.003])
@pytest.mark.parametrize("size", [CUP, (0.07, 0.07, 0.28), (0.2, 0.15, 0.03), (0.18, 0.03, 0.015)])
def test_a_thing_is_there_or_is_gone(size, noise_m):
    there = picture([((0.1, 0.05, TABLE_Z), size)], noise_m=noise_m)
    assert occupancy_in([there])(stands(0.1, 0.05), size) == "occupied"
    assert occupancy_in([picture(noise_m=noise_m)])(stands(0.1, 0.05), size) == "free"


def test_what_stands_behind_something_is_hidden():
    screen = ((0.0, -0.15, TABLE_Z), (0.4, 0.02, 0.4))
    assert occupancy_in([picture([screen])])(stands(0.0, 0.1), CUP) == "unknown"


AHEAD_M = 3.0
SMALL, LARGE, LARGE_BUT_THIN = (0.3, 0.3, 0.3), (0.6, 0.6, 0.3), (0.6, 0.6, 0.09)
PASSED_M, BEFORE_IT_M, ON_IT_M = 9.0, 1.0, AHEAD_M


@pytest.mark.parametrize(
    ("size", "shares", "occupancy"),
    [
        (SMALL, {PASSED_M: 1.0}, "free"),
        (SMALL, {PASSED_M: 0.8, ON_IT_M: 0.2}, "free"),
        (SMALL, {PASSED_M: 0.65, ON_IT_M: 0.35}, "occupied"),
        (LARGE, {PASSED_M: 0.95, ON_IT_M: 0.05}, "free"),
        (LARGE, {PASSED_M: 0.8, ON_IT_M: 0.2}, "occupied"),
        (LARGE_BUT_THIN, {PASSED_M: 0.8, ON_IT_M: 0.2}, "free"),
        (SMALL, {PASSED_M: 0.6, BEFORE_IT_M: 0.4}, "free"),
        (SMALL, {PASSED_M: 0.4, BEFORE_IT_M: 0.6}, "unknown"),
        (SMALL, {PASSED_M: 0.4, np.nan: 0.6}, "unknown"),
        (SMALL, {AHEAD_M - 0.01: 1.0}, "occupied"),
        (SMALL, {AHEAD_M - 0.05: 1.0}, "unknown"),
        (SMALL, {AHEAD_M + 0.19: 1.0}, "occupied"),
        (SMALL, {AHEAD_M + 0.23: 1.0}, "free"),
        (LARGE, {AHEAD_M + 0.23: 1.0}, "occupied"),
        (LARGE, {AHEAD_M + 0.32: 1.0}, "free"),
        ((0.03, 0.03, 0.3), {PASSED_M: 1.0}, "unknown"),
    ],
)
def test_a_place_is_judged_by_where_its_rays_end(size, shares, occupancy):
    """The camera looks along the height of the box, which starts 3 m ahead."""
    depth = np.random.default_rng(0).choice([*shares], (HEIGHT, WIDTH), p=[*shares.values()])
    cloud = cloud_of(depth.astype(np.float32), None, INTRINSICS, np.eye(4))
    assert occupancy_in([cloud])(stands(0.0, 0.0, AHEAD_M), size) == occupancy


@pytest.mark.parametrize(
    ("yaw", "half_m", "occupancy"),
    [(0.7, 0.38, "free"), (0.7, 0.25, "occupied"), (0.3, 0.38, "occupied"), (-0.7, 0.38, "occupied")],
)
def test_all_rays_through_a_turned_box_count_and_no_others(yaw, half_m, occupancy):
    """The camera looks through a diagonal slot, along the height of a long box."""
    u, v = np.meshgrid(np.arange(WIDTH) + 0.5 - WIDTH / 2, np.arange(HEIGHT) + 0.5 - HEIGHT / 2)
    along = np.abs(u * np.cos(0.7) + v * np.sin(0.7)) * AHEAD_M / FOCAL
    aside = np.abs(v * np.cos(0.7) - u * np.sin(0.7)) * AHEAD_M / FOCAL
    depth = np.where((along < half_m) & (aside < 0.07), PASSED_M, ON_IT_M).astype(np.float32)
    box = stands(0.0, 0.0, AHEAD_M, yaw), (0.9, 0.12, 0.12)
    assert occupancy_in([cloud_of(depth, None, INTRINSICS, np.eye(4))])(*box) == occupancy


CHAIR = (0.45, 0.45, 0.9)


def chair(x: float, y: float) -> list[tuple[tuple[float, float, float], tuple[float, float, float]]]:
    """Return a chair with its back, of two posts and two rails, on the far side."""
    posts = [((x + side * 0.2, y + 0.205, TABLE_Z), (0.04, 0.03, 0.9)) for side in (-1, 1)]
    rails = [((x, y + 0.205, TABLE_Z + z), (0.36, 0.03, 0.08)) for z in (0.58, 0.8)]
    legs = [((x + side * 0.2, y - 0.2, TABLE_Z), (0.04, 0.04, 0.42)) for side in (-1, 1)]
    return [*posts, *rails, *legs, ((x, y, TABLE_Z + 0.42), (0.45, 0.45, 0.03))]


@pytest.mark.parametrize("noise_m", [0.0, 0.003])
def test_a_chair_of_which_only_the_slats_of_its_back_are_in_sight_is_there(noise_m):
    table = ((0.0, -0.75, TABLE_Z), (1.2, 0.8, 0.5))
    pose = looking_down(0.45, 3.0)
    there = picture([table, *chair(0.0, 0.0)], pose, noise_m)
    assert occupancy_in([there])(stands(0.0, 0.0), CHAIR) == "occupied"
    assert occupancy_in([picture([table], pose, noise_m)])(stands(0.0, 0.0), CHAIR) == "free"


def test_what_stands_behind_a_large_thing_that_is_gone_does_not_fill_its_place():
    wall = ((0.0, 0.28, TABLE_Z), (3.0, 0.1, 1.5))
    assert occupancy_in([picture([wall], looking_down(0.45, 3.0))])(stands(0.0, 0.0), CHAIR) == "free"


def test_a_neighbour_does_not_fill_a_place():
    neighbour = ((0.09, 0.0, TABLE_Z), CUP)
    assert occupancy_in([picture([neighbour])])(stands(0.0, 0.0), CUP) == "free"


@pytest.mark.parametrize(
    "place", [stands(5.0, 0.0), stands(0.0, -3.0), stands(0.66, 0.0), stands(0.0, 0.0, 5.0)]
)
def test_what_is_out_of_view_nobody_can_tell(place):
    assert occupancy_in([picture()])(place, CUP) == "unknown"


def test_where_nothing_is_measured_nobody_can_tell():
    nothing = cloud_of(np.zeros((HEIGHT, WIDTH), np.float32), None, INTRINSICS, looking_down())
    assert occupancy_in([nothing])(stands(0.0, 0.0), CUP) == "unknown"
    assert occupancy_in([])(stands(0.0, 0.0), CUP) == "unknown"


def test_of_two_views_the_one_that_sees_something_counts():
    screen = ((0.0, -0.15, TABLE_Z), (0.4, 0.02, 0.4))
    above = looking_down(1.4)
    assert occupancy_in([picture([screen]), picture([screen], above)])(stands(0.0, 0.1), CUP) == "free"
    cup = ((0.0, 0.1, TABLE_Z), CUP)
    assert (
        occupancy_in([picture([screen, cup]), picture([screen, cup], above)])(stands(0.0, 0.1), CUP)
        == "occupied"
    )


@settings(deadline=None, max_examples=40)
@given(st.floats(-0.3, 0.3), st.floats(-0.2, 0.2), st.floats(-3.1, 3.1), st.floats(0.4, 1.4))
def test_an_empty_table_is_free_everywhere_in_view(x, y, yaw, angle_rad):
    view = occupancy_in([picture(pose=looking_down(angle_rad))])
    assert view(stands(x, y, yaw=yaw), (0.1, 0.06, 0.12)) == "free"
