"""The stages of segmentation on a drawn room, with what each of them finds."""

from pathlib import Path

import numpy as np

from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.segmentation import gravity, merge_model, pairs
from semmap.nodes.perception_node.segmentation.merging import merge
from semmap.nodes.perception_node.segmentation.normals import normals
from semmap.nodes.perception_node.segmentation.patches import grown, patches
from semmap.nodes.perception_node.segmentation.planes import find_planes, thickness_m
from semmap.nodes.perception_node.segmentation.segment import segment, split_into_patches
from semmap.nodes.perception_node.segmentation.thin_things import thin_things
from semmap.nodes.perception_node.segmentation.unorganised_cloud import as_image
from semmap.nodes.perception_node.segmentation.working_image import grid_of, shades_of, shifted, spread
from tests.perception_node.drawn import check, cloud, counts, summary

FOLDER = Path(__file__).parent / "stages"


def described(planes):
    return [
        value
        for plane in planes
        for value in (*plane.normal.tolist(), plane.offset_m, plane.kind, plane.points, *plane.sides_m)
    ]


def working_images():
    found = {}
    for scale in (1, 2, 3):
        grid = grid_of(cloud("left", scale))
        found[f"{scale} points"] = [grid.step, *summary(grid.points)]
        found[f"{scale} weights"] = [*summary(grid.weights), *np.nansum(grid.weights, axis=(1, 2)).tolist()]
        where = np.isfinite(grid.points[2]) & (grid.points[2] < 1.4)
        found[f"{scale} shades"] = summary(grid.shades(where))
        labels = np.where(where, 1 + (np.arange(where.shape[1]) // 40), 0).astype(np.int32)
        found[f"{scale} spread"] = counts(spread(grid, labels))
    grid = grid_of(Cloud(cloud("left", 2).points_camera[:-1, :-3]))
    found["odd sides"] = [grid.step, *summary(grid.points), *summary(grid.shades(np.ones((1, 1), bool)))]
    found["shades"] = shades_of(np.array([[255, 0, 20], [0, 255, 30], [0, 0, 200]])).ravel().tolist()
    image = np.arange(12).reshape(3, 4)
    for shift in ((0, 1), (1, 0), (1, -1), (2, 2), (5, 0), (0, -9)):
        found[f"shifted {shift}"] = [
            value for view in shifted(image, *shift) for value in view.ravel().tolist()
        ]
    return found


def planes_of_the_room():
    found = {"thickness": thickness_m(np.array([0.5, 1.0, 2.0, 3.0], np.float32)).tolist()}
    for camera in ("left", "right"):
        seen = cloud(camera)
        points = grid_of(seen).points
        for name, pose, tops in (
            ("known", seen.map_from_camera, False),
            ("unknown", None, False),
            ("tops", seen.map_from_camera, True),
        ):
            planes, labels = find_planes(points, pose, np.random.default_rng(0), keep_tops=tops)
            found[f"{camera} {name}"] = [*described(planes), *counts(labels)]
        planes, of_plane = find_planes(points, seen.map_from_camera, np.random.default_rng(0))
        found[f"{camera} heights"] = [v for plane in planes for v in summary(plane.height_m(points))]
        found[f"{camera} thin"] = counts(thin_things(points, planes, of_plane))
        pose = gravity.room_pose(points)
        found[f"{camera} gravity"] = [] if pose is None else pose.ravel().tolist()
    return found


def patches_of_the_room():
    found = {}
    for camera in ("left", "right"):
        parts = split_into_patches(cloud(camera))
        points = parts.grid.points
        where = np.isfinite(points[2]) & (parts.of_plane == 0)
        surface = normals(points, where)
        found[f"{camera} normals"] = [v for axis in surface for v in summary(axis)]
        found[f"{camera} patches alone"] = counts(patches(points, surface, where))
        seeds = np.where(np.arange(where.size).reshape(where.shape) % 97 == 0, 1, 0).astype(np.int32) * where
        found[f"{camera} grown"] = counts(grown(seeds, points, where))
        found[f"{camera} patches"] = counts(parts.of_patch)
        of = parts.statistics
        for name in ("inside", "low", "high"):
            for column, values in enumerate(getattr(of, name).T):
                found[f"{camera} {name} {column}"] = summary(values)
        for column in range(of.between.shape[-1]):
            found[f"{camera} between {column}"] = summary(of.between[..., column])
        found[f"{camera} supports"] = of.supports.tolist()
        a, b = np.nonzero(np.triu(pairs.candidates(of)))
        for name, values in zip(pairs.NAMES, pairs.features(of, a, b).T, strict=True):
            found[f"{camera} pairs {name}"] = summary(values)
        merged = merge(of.copy(), merge_model.shipped())
        found[f"{camera} merged"] = [*merged.number.tolist(), *summary(merged.same)]
    return found


def segments_of_the_room():
    found = {}
    for camera in ("left", "right"):
        for name, seen in (
            ("known", cloud(camera)),
            ("unknown", cloud(camera, known=False)),
            ("fine", cloud(camera, 2)),
        ):
            made = segment(seen)
            found[f"{camera} {name}"] = [
                *counts(made.labels),
                *counts(made.plane_labels),
                *summary(made.same),
            ]
    seen = cloud("left")
    flat = Cloud(seen.points_camera.reshape(1, -1, 3), seen.colors.reshape(1, -1, 3), seen.map_from_camera)
    image, pixel = as_image(flat)
    found["unorganised image"] = [*image.points_camera.shape, *summary(image.points_camera), *summary(pixel)]
    found["unorganised colours"] = summary(image.colors)
    made = segment(flat)
    found["unorganised"] = [*counts(made.labels), *counts(made.plane_labels)]
    thinned = Cloud(flat.points_camera[:, ::7], None, seen.map_from_camera)
    image, pixel = as_image(thinned)
    found["thinned"] = [*image.points_camera.shape, *summary(image.points_camera), *summary(pixel)]
    return found


def test_cells_of_the_working_image_are_the_means_of_their_nearest_surface():
    check(working_images(), FOLDER / "working_images.json")


def test_planes_are_the_floor_and_the_table_top_and_the_book_is_a_thin_thing():
    check(planes_of_the_room(), FOLDER / "planes.json")


def test_patches_and_their_borders_have_these_statistics():
    check(patches_of_the_room(), FOLDER / "patches.json")


def test_objects_are_found_with_and_without_the_pose_and_in_unorganised_clouds():
    check(segments_of_the_room(), FOLDER / "segments.json")
