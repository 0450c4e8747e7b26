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


@pytest.mark.parametrize(
    ("rise", "noise_m", "tolerance_m", "pieces"),
    [
        (0.0, 0.0, 0.009, 1),
        (0.4, 0.0, 0.009, 1),
        (0.6, 0.0, 0.009, 0),
        (1.0, 0.0, 0.009, 0),
        (0.0, 0.01, 0.04, 1),
        (0.0, 0.01, 0.001, 0),
    ],
)
def test_a_slice_rises_from_row_to_row_by_more_than_the_noise(rise, noise_m, tolerance_m, pieces):
    """The rows are 1 cm apart, and those are compared that are farther apart than the tolerance."""
    row, column = np.mgrid[:40, :40] * 0.01
    height = row * rise + np.random.default_rng(0).normal(0.0, noise_m, row.shape)
    points = np.stack([column, -height, row * np.sqrt(1.0 - rise**2)]).astype(np.float32)
    on, tolerance = np.ones(row.shape, bool), np.full(row.shape, tolerance_m, np.float32)
    assert len(pieces_of(on, points, height.astype(np.float32), tolerance, 50)) == pieces


@pytest.mark.parametrize(("between_m", "counts"), [(0.5, [200]), (np.nan, [120, 80]), (-0.5, [120, 80])])
def test_a_plane_goes_on_behind_an_occluder_and_ends_where_the_camera_looks_past_it(between_m, counts):
    row, column = np.mgrid[:10, :21] * 0.01
    on = np.ones(row.shape, bool)
    on[:, 8] = False
    height = np.where(on, 0.0, between_m).astype(np.float32)
    points = np.stack([column, -height, row]).astype(np.float32)
    pieces = pieces_of(on, points, height, np.full(row.shape, 0.009, np.float32), 20)
    assert [int(piece.sum()) for piece in pieces] == counts
    assert not any(piece[:, 8].any() for piece in pieces)


def level(height_m, width_m, depth_m, middle_m=1.5):
    """Return points (3, h, w) every 1 cm of a level rectangle, in a camera 1.5 m above the floor."""
    row, column = np.mgrid[: round(depth_m * 100), : round(width_m * 100)] * 0.01
    return np.stack([column - width_m / 2, np.full(row.shape, 1.5 - height_m), middle_m + depth_m / 2 - row])


def upright(width_m, high_m, at_m=1.5, foot_m=0.7):
    """Return points (3, h, w) of an upright rectangle that faces that camera."""
    row, column = np.mgrid[: round(high_m * 100), : round(width_m * 100)] * 0.01
    return np.stack([column - width_m / 2, row - high_m + 1.5 - foot_m, np.full(row.shape, at_m)])


def kinds_of(*rectangles, **options):
    """Return the kind and height of each plane of an image that has one rectangle above the other."""
    width = max(part.shape[2] for part in rectangles)
    gap = np.full((3, 2, width), np.nan)
    rows = [np.pad(r, ((0, 0), (0, 0), (0, width - r.shape[2])), constant_values=np.nan) for r in rectangles]
    points = np.concatenate([part for row in rows for part in (row, gap)], axis=1).astype(np.float32)
    pose = np.array([[1.0, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 1.5], [0, 0, 0, 1]])
    planes, of_plane = find_planes(points, pose, np.random.default_rng(0), **options)
    assert [np.count_nonzero(of_plane == n) for n in range(1, len(planes) + 1)] == [p.points for p in planes]
    return sorted((p.kind, round(float(1.5 + p.offset_m), 2)) for p in planes if p.kind != "wall")


GROUND = level(0.0, 2.0, 1.0)
ON_THE_GROUND = ("floor", 0.0)


@pytest.mark.parametrize(
    ("rectangles", "supports"),
    [
        ([level(0.3, 1.0, 0.25)], []),
        ([level(0.3, 1.0, 0.45)], [0.3]),
        ([level(0.8, 1.0, 0.25)], [0.8]),
        ([level(0.8, 1.0, 0.15)], []),
        ([level(0.8, 0.35, 0.35)], [0.8]),
        ([level(0.8, 0.25, 0.25)], []),
        ([level(0.8, 1.6, 0.15), level(0.8, 0.45, 0.45, 2.3)], [0.8]),
        ([level(0.7, 1.0, 0.4), upright(1.0, 1.2)], [0.7, 0.7]),
        ([level(0.7, 1.5, 0.8), level(0.95, 0.5, 0.5)], [0.7]),
        ([level(0.7, 1.5, 0.8), level(0.95, 1.5, 0.7)], [0.7, 0.95]),
        ([level(0.7, 1.5, 0.8), level(1.25, 0.5, 0.5)], [0.7, 1.25]),
        ([level(0.7, 1.5, 0.8), level(0.95, 0.5, 0.5, 2.3)], [0.7, 0.95]),
    ],
    ids=[
        "narrow",
        "wide",
        "narrow and high",
        "too narrow and high",
        "small",
        "less than a twenty-fifth of all points",
        "wide beside a narrow one",
        "with a board across it",
        "top of a thing on a table",
        "shelf above a shelf",
        "high above a table",
        "beside a table",
    ],
)
def test_supports_are_wide_enough_and_no_tops_of_things(rectangles, supports):
    expected = [ON_THE_GROUND, *(("support", height) for height in supports)]
    assert kinds_of(GROUND, *rectangles) == expected


def test_tops_of_things_are_planes_where_they_are_asked_for():
    found = kinds_of(GROUND, level(0.7, 1.5, 0.8), level(0.95, 0.5, 0.5), keep_tops=True)
    assert found == [ON_THE_GROUND, ("support", 0.7), ("support", 0.95)]


@pytest.mark.parametrize(("share", "supports"), [(0.1, 1), (0.3, 0), (None, 1)])
def test_a_plane_has_a_least_share_of_all_points(share, supports):
    found = kinds_of(GROUND, level(0.7, 1.0, 0.5), least_share=share)
    assert [kind for kind, _ in found] == ["floor", *["support"] * supports]
