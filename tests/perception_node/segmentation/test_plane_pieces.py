"""Pieces of level planes."""

from __future__ import annotations

import numpy as np
import pytest

from semmap.nodes.perception_node.segmentation.plane_pieces import pieces_of
from semmap.nodes.perception_node.segmentation.planes import find_planes
from semmap.nodes.perception_node.segmentation.working_image import grid_of
from tests.perception_node.segmentation.scenes import boxes_on_table, camera_pose

FLOOR = ((-3, -3, -0.1), (3, 3, 0.0))
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
