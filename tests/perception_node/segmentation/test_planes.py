"""Dominant planes."""

from __future__ import annotations

import numpy as np
import pytest

from semmap.nodes.perception_node.segmentation.planes import find_planes, largest_piece, pieces_of
from semmap.nodes.perception_node.segmentation.working_image import grid_of
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


@pytest.mark.parametrize("seed", range(5))
def test_floor_support_and_wall_are_told_apart(seed):
    pose = camera_pose(eye=(0.0, -2.0, 1.7), target=(0.0, 0.3, 0.7))
    floor = ((-3, -3, -0.1), (3, 3, 0.0))
    table = ((-0.6, -0.5, 0.70), (0.6, 0.5, 0.75))
    wall = ((-3, 1.5, 0.0), (3, 1.6, 2.5))
    seen = boxes_on_table(table, wall, pose=pose, posed=True, table=floor)
    planes, of_plane = find_planes(
        grid_of(seen.cloud).points, seen.cloud.map_from_camera, np.random.default_rng(seed)
    )
    kinds = {plane.kind: n for n, plane in enumerate(planes, 1)}
    assert set(kinds) == {"floor", "support", "wall"}
    truth = seen.truth[::2, ::2]
    assert (truth[of_plane == kinds["wall"]] == 2).mean() > 0.95
    assert (truth[of_plane == kinds["support"]] == 1).mean() > 0.95


POSED = {"pose": camera_pose(eye=(0.0, -1.6, 1.9), target=(0.0, 0.0, 0.8)), "posed": True}
TABLE = ((-0.6, -0.5, 0.70), (0.6, 0.5, 0.75))
FLOOR = ((-3, -3, -0.1), (3, 3, 0.0))


@pytest.mark.parametrize(
    "things",
    [
        pytest.param((((-0.3, -0.25, 0.75), (0.15, 0.2, 1.05)),), id="one that is as large as a stool"),
        pytest.param(
            tuple(((x, y, 0.75), (x + 0.2, y + 0.2, 1.0)) for x in (-0.5, 0.3) for y in (-0.4, 0.2)),
            id="several of one height",
        ),
    ],
)
def test_the_tops_of_what_stands_on_a_table_are_no_supports(things):
    seen = boxes_on_table(TABLE, *things, **POSED, table=FLOOR)
    planes, of_plane = find_planes(
        grid_of(seen.cloud).points, seen.cloud.map_from_camera, np.random.default_rng(0)
    )
    assert sorted(plane.kind for plane in planes) == ["floor", "support"]
    assert of_plane.max() == 2
    support = 1 + [plane.kind for plane in planes].index("support")
    assert (seen.truth[::2, ::2][of_plane == support] == 1).mean() > 0.9


def test_a_shelf_above_a_shelf_is_a_support():
    shelves = [((-0.5, 0.0, z - 0.02), (0.5, 0.4, z)) for z in (0.7, 1.1)]
    seen = boxes_on_table(
        *shelves, pose=camera_pose(eye=(0.0, -1.4, 1.6), target=(0.0, 0.2, 0.9)), posed=True, table=FLOOR
    )
    planes, _ = find_planes(grid_of(seen.cloud).points, seen.cloud.map_from_camera, np.random.default_rng(0))
    assert sorted(plane.kind for plane in planes) == ["floor", "support", "support"]


@pytest.mark.parametrize("points", [np.full((3, 8, 8), np.nan), np.ones((3, 8, 8)), np.zeros((3, 40, 40))])
def test_no_plane_in_what_has_none(points):
    planes, of_plane = find_planes(points.astype(np.float32), None, np.random.default_rng(0))
    assert planes == ()
    assert not of_plane.any()


LEFT, RIGHT = ((-1.0, -0.4, 0.70), (-0.3, 0.4, 0.75)), ((0.3, -0.4, 0.70), (1.0, 0.4, 0.75))
WHOLE = ((-1.0, -0.4, 0.70), (1.0, 0.4, 0.75))
POST = ((-0.1, -0.7, 0.0), (0.1, -0.6, 1.6))
POSE = camera_pose(eye=(0.0, -2.0, 1.5), target=(0.0, 0.0, 0.7))


def supports(*boxes):
    """Return the boxes on which each support is visible."""
    seen = boxes_on_table(*boxes, pose=POSE, posed=True, table=FLOOR)
    planes, of_plane = find_planes(
        grid_of(seen.cloud).points, seen.cloud.map_from_camera, np.random.default_rng(0)
    )
    truth = seen.truth[::2, ::2]
    return [
        set(np.unique(truth[of_plane == n]).tolist()) - {0}  # at its edge
        for n, plane in enumerate(planes, 1)
        if plane.kind == "support"
    ]


def test_two_tables_of_one_height_are_two_supports():
    assert sorted(supports(LEFT, RIGHT), key=min) == [{1}, {2}]


def test_a_table_goes_on_behind_what_stands_before_it():
    assert supports(WHOLE, POST) == [{1}]


def test_what_a_plane_merely_cuts_through_is_no_piece_of_it():
    seen = boxes_on_table(((-0.5, 0.0, 0.0), (0.5, 0.5, 1.0)), pose=POSE, posed=True, table=FLOOR)
    points = grid_of(seen.cloud).points
    up, down = POSE[2, :3].astype(np.float32), np.float32(0.5 - POSE[2, 3])
    height = np.tensordot(up, points, axes=1) - down  # a level plane through the middle of the box
    on = np.abs(height) < 0.03
    assert on.sum() > 500
    thickness = np.full(on.shape, 0.03, np.float32)
    assert pieces_of(on, points, height, thickness, 50) == []


@pytest.mark.parametrize("least", [1, 10_000_000])
def test_a_piece_of_too_few_cells_is_none(least):
    seen = boxes_on_table(LEFT, pose=POSE, posed=True, table=FLOOR)
    points = grid_of(seen.cloud).points
    on = seen.truth[::2, ::2] == 1
    height = np.where(on, np.float32(0.0), np.float32(-1.0))
    pieces = pieces_of(on, points, height, np.full(on.shape, 0.01, np.float32), least)
    assert len(pieces) == (1 if least == 1 else 0)


@pytest.mark.parametrize("order", [1, -1])
def test_the_largest_of_several_pieces_is_kept(order):
    on = np.array([[1, 0, 1, 1, 1, 0, 1, 1], [1, 0, 1, 0, 1, 0, 1, 0]], bool)[:, ::order]
    kept = np.array([[0, 0, 1, 1, 1, 0, 0, 0], [0, 0, 1, 0, 1, 0, 0, 0]], bool)[:, ::order]
    assert (largest_piece(on) == kept).all()
    assert (largest_piece(kept) == kept).all()
