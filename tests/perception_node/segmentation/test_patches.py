"""Each patch is on one object, and patches cover the objects."""

from __future__ import annotations

import numpy as np
import pytest

from semmap.nodes.perception_node.segmentation.patches import patches
from tests.perception_node.segmentation.scenes import boxes_on_table
from tests.perception_node.segmentation.taken_apart import apart

SCENES = {
    "apart": [((-0.2, -0.1, 0), (-0.1, 0, 0.1)), ((0.1, -0.1, 0), (0.2, 0, 0.1))],
    "side by side": [((-0.1, -0.1, 0), (0, 0, 0.1)), ((0, -0.12, 0), (0.1, 0.02, 0.17))],
    "on one another": [((-0.1, -0.1, 0), (0.1, 0.1, 0.1)), ((-0.05, -0.05, 0.1), (0.04, 0.05, 0.2))],
    "one behind": [((-0.14, 0.05, 0), (0.14, 0.1, 0.1)), ((-0.03, -0.1, 0), (0.03, -0.05, 0.2))],
}


@pytest.mark.parametrize("boxes", SCENES.values(), ids=SCENES)
def test_each_patch_is_of_one_box_and_together_they_are_all(boxes):
    seen = boxes_on_table(*boxes)
    parts, _ = apart(seen)
    truth = seen.truth[::2, ::2]
    for number in range(1, parts.of_patch.max() + 1):
        counts = np.bincount(truth[parts.of_patch == number], minlength=3)
        assert counts[1:].min() < 0.05 * counts.sum()
        assert counts[0] < 0.5 * counts.sum()  # at borders a cell takes a pixel of the table in
    for box in (1, 2):
        assert (parts.of_patch[truth == box] > 0).mean() > 0.8


def test_nothing_outside_what_is_asked_for():
    seen = boxes_on_table(*SCENES["apart"])
    points = np.moveaxis(seen.cloud.points_camera[::2, ::2], -1, 0)
    where = np.zeros(points.shape[1:], dtype=bool)
    assert not patches(points, np.full_like(points, np.nan), where).any()
    where[100:140, 100:140] = True
    labels = patches(points, np.broadcast_to(np.float32([[[0]], [[0]], [[-1]]]), points.shape), where)
    assert set(np.unique(labels[where])) <= set(range(labels.max() + 1))
    assert not labels[~where].any()


@pytest.mark.parametrize("height", range(1, 7))
@pytest.mark.parametrize("width", range(1, 7))
def test_a_picture_may_be_smaller_than_what_is_looked_across(height, width):
    x, y = np.meshgrid(np.arange(width) * 0.01, np.arange(height) * 0.01)
    points = np.stack([x, y, np.ones_like(x)]).astype(np.float32)
    facing = np.zeros_like(points)
    facing[2] = -1.0
    labels = patches(points, facing, np.ones((height, width), bool))
    assert labels.shape == (height, width)
    assert set(np.unique(labels)) == ({1} if height * width >= 12 else {0})


def roof(bend_deg, *, step_m=0.0, pitch_m=0.002, side=12):
    """Return points (3, h, w) of two planes that meet in a ridge, or a valley if negative, and normals."""
    half = np.radians(bend_deg) / 2.0
    column, row = np.meshgrid(np.arange(-side, side) + 0.5, np.arange(2 * side))
    right = np.sign(column)
    points = np.stack([column * np.cos(half), row, np.abs(column) * np.sin(half)]) * pitch_m
    points[2] += 1.0 + step_m * (right > 0)
    facing = np.stack([np.sin(half) * right, 0 * right, -np.cos(half) + 0 * right])
    return points.astype(np.float32), facing.astype(np.float32)


@pytest.mark.parametrize(
    ("bend_deg", "step_m", "count"),
    [
        (0.0, 0.0, 1),
        (25.0, 0.0, 1),
        (40.0, 0.0, 2),
        (-10.0, 0.0, 1),
        (-25.0, 0.0, 2),
        (0.0, 0.005, 1),
        (0.0, 0.01, 2),
        (0.0, -0.01, 2),
    ],
)
@pytest.mark.parametrize("upright", [False, True])
def test_a_patch_ends_at_valleys_sharp_ridges_and_steps(bend_deg, step_m, count, upright):
    points, facing = roof(bend_deg, step_m=step_m)
    if upright:
        points, facing = (of.transpose(0, 2, 1)[[1, 0, 2]] for of in (points, facing))
    labels = patches(points, facing, np.ones(points.shape[1:], bool))
    left, right = (labels.T if upright else labels)[:, [0, -1]].T
    assert labels.max() == count
    assert labels.min() == 1
    assert (left != right).all() == (count == 2)
