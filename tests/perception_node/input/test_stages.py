"""Clouds of a drawn room as other sources give them: another axis up, another origin, depth images, masks."""

from pathlib import Path

import numpy as np
import pytest

from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.input.projection import cloud_of, is_pose, thinned, thinning
from semmap.nodes.perception_node.input.viewpoint import Placement
from tests.perception_node.drawn import INTRINSICS, check, cloud, pose_of, summary

FOLDER = Path(__file__).parent / "stages"
FROM_Z = {"x": [[0, 0, 1], [0, 1, 0], [-1, 0, 0]], "y": [[1, 0, 0], [0, 0, 1], [0, -1, 0]], "z": np.eye(3)}


def in_map(seen):
    pose = seen.map_from_camera
    return (seen.points_camera @ pose[:3, :3].T.astype(np.float32) + pose[:3, 3]).astype(np.float32)


def placed_clouds():
    found = {}
    for camera in ("left", "right"):
        seen = cloud(camera)
        points = in_map(seen)[::2, ::2]
        for up, turn in FROM_Z.items():
            turned = points @ np.array(turn, np.float32).T
            for name, own in (("grid", turned), ("heap", turned.reshape(1, -1, 3)), ("low", turned)):
                lowered = own - np.array([0, 0, 0.4] @ np.array(turn).T, np.float32) if name == "low" else own
                placed, pose = Placement(up).place(lowered)
                found[f"{camera} {up} {name}"] = [*summary(placed), *pose.ravel().tolist()]
        given = pose_of((1.0, 2.0, 1.5))
        placed, pose = Placement("z", given).place(points)
        found[f"{camera} given"] = [*summary(placed), *pose.ravel().tolist()]
    nothing, pose = Placement("z").place(np.full((4, 4, 3), np.nan, np.float32))
    found["nothing"] = [*summary(nothing), *pose.ravel().tolist()]
    return found


def projected_images():
    seen, found = cloud("left"), {}
    depth = np.nan_to_num(seen.points_camera[..., 2])
    made = cloud_of(depth, seen.colors, INTRINSICS, seen.map_from_camera, camera="left", stamp_ns=5)
    found["points"] = [*summary(made.points_camera), made.near_m, made.measured, made.stamp_ns]
    for step in (1, 2, 3):
        fewer, colours, intrinsics = thinned(depth, seen.colors, INTRINSICS, step)
        found[f"thinned {step}"] = [*summary(fewer), *summary(colours), *intrinsics.ravel().tolist()]
        again = cloud_of(fewer, colours, intrinsics)
        found[f"again {step}"] = summary(again.points_camera)
    sizes = ((640, 480), (1280, 720), (1920, 1080), (4096, 3072), (1, 1))
    found["steps"] = [thinning(*size) for size in sizes]
    return found


def test_a_cloud_is_turned_upright_lifted_to_its_floor_and_seen_from_its_camera():
    check(placed_clouds(), FOLDER / "placed.json")


def test_a_depth_image_is_projected_through_the_centres_of_its_pixels():
    check(projected_images(), FOLDER / "projected.json")


def test_the_camera_of_an_organised_cloud_is_found_within_millimetres():
    seen = cloud("left", noise_m=0.0)
    placed, pose = Placement("z").place(in_map(seen))
    assert pose == pytest.approx(seen.map_from_camera, abs=2e-3)
    known = np.isfinite(placed)
    assert placed[known] == pytest.approx(seen.points_camera[known], abs=5e-3)


@pytest.mark.parametrize(
    ("change", "is_one"),
    [
        (lambda pose: None, True),
        (lambda pose: pose.__setitem__((0, 3), np.nan), False),
        (lambda pose: pose.__setitem__((0, 0), 2.0), False),
        (lambda pose: pose.__setitem__((3, 3), 2.0), False),
        (lambda pose: pose.__setitem__((3, 0), 0.1), False),
        (lambda pose: pose.__setitem__(slice(0, 1), -pose[0]), False),
        (lambda pose: pose.__setitem__((slice(0, 3), 3), 100.0), True),
    ],
)
def test_a_pose_is_a_rotation_and_a_translation(change, is_one):
    pose = pose_of((1.0, 1.0, 1.0))
    change(pose)
    assert is_pose(pose) == is_one


@pytest.mark.parametrize(
    ("points", "measured"),
    [
        ([[[0.0, 0.0, 1.0], [0.0, 0.0, 2.0]]], 2),
        ([[[0.0, 0.0, 0.0], [0.0, 0.0, -1.0]]], 0),
        ([[[np.nan, np.nan, np.nan], [1.0, 1.0, 0.5]]], 1),
    ],
)
def test_only_points_in_front_of_the_camera_are_measured(points, measured):
    made = Cloud(np.array(points, np.float32))
    assert made.measured == measured
    assert not made.organised
