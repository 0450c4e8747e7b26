"""Parts of a table, and things next to it."""

from __future__ import annotations

import numpy as np
import pytest

from semmap.nodes.perception_node.segmentation import Plane, Segmentation
from semmap.nodes.perception_node.views.furniture_planes import (
    _box,
    _stands_free,
    _touching,
    join_legs,
    with_furniture,
)
from semmap.nodes.perception_node.views.segments import Segment


def segment(low, high, *, carrier=False) -> Segment:
    points = np.random.default_rng(0).uniform(low, high, (500, 3)).astype(np.float32)
    return Segment(points, None, 1, np.zeros(3), cut=False, count=500, carrier=carrier)


TOP = segment([-0.5, -0.3, 0.74], [0.5, 0.3, 0.75], carrier=True)


def test_a_leg_belongs_to_the_top_and_a_bin_below_it_does_not():
    leg, bin_ = segment([0.4, 0.2, 0.0], [0.45, 0.25, 0.73]), segment([0, 0, 0], [0.2, 0.2, 0.3])
    assert join_legs([[TOP], [leg], [bin_]]) == [[0, 1], [2]]


def test_what_stands_beside_the_top_is_another_thing():
    beside = segment([0.55, -0.1, 0.0], [0.75, 0.1, 0.72])
    assert join_legs([[TOP], [beside]]) == [[0], [1]]


def test_a_front_alone_hides_nothing():
    front = segment([-0.5, -0.3, 0.0], [0.5, -0.2999, 0.75], carrier=True)
    beside = segment([-0.1, -0.6, 0.0], [0.1, -0.4, 0.7])
    assert join_legs([[front], [beside]]) == [[0], [1]]


def test_what_stands_on_a_top_ends_there():
    """On the left a thing segmented with the rim below it, on the right the top itself."""
    labels = np.zeros((40, 40), np.int32)
    labels[:, :20] = 1
    across = np.linspace(-0.3, 0.3, 40, dtype=np.float32)
    points = np.stack(np.broadcast_arrays(np.abs(across), across[:, None], np.float32(0.8)), axis=-1).copy()
    points[:, :20, :2] *= 0.8
    points[:, :20, 2] = np.linspace(1.06, 0.56, 40)[:, None]
    top = Plane(np.array([0.0, 0.0, 1.0]), 0.8, "support", 800, (0.6, 0.3))
    seen = Segmentation(labels, (top,), 1 - labels, np.zeros((1, 1), np.float32))
    cut, furniture = with_furniture(seen, points[::4, ::4])
    assert furniture == {2}
    assert (cut[points[..., 2] < 0.73] == 2).all()
    assert (cut[:, :20][points[:, :20, 2] > 0.83] == 1).all()


def test_each_piece_of_furniture_is_a_thing_with_its_fronts_and_the_room_is_none():
    """Two tops are apart, the second has a front below it, and a wall goes on outside the picture."""
    row, column = np.indices((40, 48))
    top, other_top, front, wall = np.s_[:20, :16], np.s_[:20, 24:44], np.s_[20:, 26:42], np.s_[20:, :16]
    points = np.stack([column * 0.05, row * 0.01, np.full(row.shape, 0.7)], axis=-1)
    points[front] = np.stack([column * 0.05, 0.17 + 0 * row, 1.3 - row * 0.03], axis=-1)[front]
    labels, planes = np.zeros((2, 40, 48), np.int32)
    labels[:8, 17:21], labels[24:36, 18:22] = 1, 2
    expected = labels.copy()
    for number, (where, body) in enumerate(((top, 3), (other_top, 4), (front, 4), (wall, 0)), 1):
        planes[where], expected[where] = number, body
    kinds = [
        Plane(np.array([0.0, 0.0, 1.0]), 0.7, kind, 300, (1.0, 0.2))
        for kind in ("support", "support", "wall", "wall")
    ]
    seen = Segmentation(labels, tuple(kinds), planes, np.zeros((2, 2), np.float32))
    cut, furniture = with_furniture(seen, points[::4, ::4].astype(np.float32))
    assert furniture == {3, 4}
    np.testing.assert_array_equal(cut, expected)


def corners(low, high):
    return np.array(low, np.float32), np.array(high, np.float32)


def test_boxes_that_touch_hang_together_also_by_others():
    row = [corners((k, 0, 0), (k + 0.98, 1, 1)) for k in range(3)]  # two centimetres apart
    assert _touching(row) == [0, 0, 0]
    assert len(set(_touching([row[0], row[2], row[1]]))) == 1
    assert _touching([row[0], row[2]]) == [0, 1]
    assert _touching([]) == []


def test_boxes_that_are_apart_along_any_axis_do_not_hang_together():
    cube = corners((0, 0, 0), (1, 1, 1))
    for axis in range(3):
        for away in (1.05, -1.05):
            low, high = cube[0].copy(), cube[1].copy()
            low[axis] += away
            high[axis] += away
            assert _touching([cube, (low, high)]) == [0, 1]


def upright(width_m, height_m):
    across, up = np.meshgrid(np.linspace(0, width_m, 60), np.linspace(0, height_m, 60))
    return np.stack([0 * across, across, up], axis=-1).reshape(-1, 3).astype(np.float32)


def test_an_upright_plane_stands_free_if_it_ends_within_the_picture_and_is_no_wall():
    mask = np.zeros((20, 20), bool)
    mask[5:, 5:15] = True  # down to the picture's lower edge
    assert _stands_free(upright(1.0, 1.8), mask)
    assert not _stands_free(upright(1.0, 2.4), mask)
    assert not _stands_free(upright(2.4, 1.8), mask)
    for edge in (np.s_[0, 7], np.s_[9, 0], np.s_[9, -1]):
        cut = mask.copy()
        cut[edge] = True
        assert not _stands_free(upright(1.0, 1.8), cut)


def test_the_box_of_points_leaves_stray_ones_out():
    points = np.concatenate([upright(1.0, 2.0), [[0.0, 50.0, 50.0]]]).astype(np.float32)
    low, high = _box(points)
    assert high[2] == pytest.approx(2.0, abs=0.05)
    assert low[2] == pytest.approx(0.0, abs=0.05)
    low, high = _box(np.empty((0, 3), np.float32))
    assert (low == np.inf).all()
    assert (high == -np.inf).all()


def test_what_lies_on_a_top_is_another_thing():
    plate = segment([-0.1, -0.1, 0.755], [0.1, 0.1, 0.76])
    assert join_legs([[TOP], [plate]]) == [[0], [1]]
    rim = segment([-0.5, -0.3, 0.7], [0.5, -0.29, 0.74])
    assert join_legs([[TOP], [rim], [plate]]) == [[0, 1], [2]]
