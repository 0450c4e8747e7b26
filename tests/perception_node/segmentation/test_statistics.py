"""Sums of a union are the sums of its parts."""

from __future__ import annotations

import numpy as np
import pytest

from semmap.nodes.perception_node.segmentation import statistics as s
from semmap.nodes.perception_node.segmentation.pairs import NAMES, candidates, features
from tests.perception_node.segmentation.scenes import boxes_on_table
from tests.perception_node.segmentation.taken_apart import apart

POINTS = np.ones((3, 30, 40), np.float32)
POINTS[1], POINTS[0] = np.mgrid[0:30, 0:40] * 0.01
POINTS[2, 10:20, 30:] -= 0.2
NORMALS = np.broadcast_to(np.float32([[[0]], [[0]], [[-1]]]), POINTS.shape)
LABELS = np.zeros((30, 40), np.int32)
LABELS[:10, :30], LABELS[10:20, :30], LABELS[20:, :30], LABELS[10:20, 30:] = 1, 2, 3, 4
UPRIGHT = s.Upright(np.eye(3), np.zeros(1))


def of(labels):
    return s.statistics(labels, POINTS, NORMALS, np.full_like(POINTS, np.nan), UPRIGHT)


def test_colours_are_compared_where_there_are_any():
    shades = np.zeros_like(POINTS)
    shades[:, LABELS == 2] = [[0.5], [0.3], [0.4]]
    known = s.statistics(LABELS, POINTS, NORMALS, shades, UPRIGHT)
    first, second = np.array([0, 0, 0]), np.array([1, 2, 3])
    rows = features(known, first, second)
    coloured, there = NAMES.index("coloured"), NAMES.index("coloured_there")
    np.testing.assert_allclose(rows[:, coloured], [0.5, 0.0, 0.0], atol=1e-6)
    np.testing.assert_allclose(rows[:, there], [0.5, -1.0, -1.0], atol=1e-6)
    np.testing.assert_array_equal(features(of(LABELS), first, second)[:, [coloured, there]], -1.0)


def test_counts_bounds_and_borders():
    known = of(LABELS)
    np.testing.assert_array_equal(known.inside[:, s.COUNT], [300, 300, 300, 100])
    np.testing.assert_allclose(known.low[1], [0.0, 0.1, 1.0], atol=1e-6)
    np.testing.assert_allclose(known.high[1], [0.29, 0.19, 1.0], atol=1e-6)
    assert known.between[0, 1, s.TOUCH] == 30
    assert known.between[1, 3, s.TOUCH] == known.between[1, 3, s.STEP] == 10
    assert known.between[3, 1, s.BEFORE] == 10
    assert known.between[1, 3, s.BEFORE] == 0
    assert known.between[0, 2, s.SIGHT] > 0
    assert known.inside[1, s.HIDDEN] == 10


def test_a_merged_patch_has_the_sums_of_both():
    known, merged = of(LABELS), of(np.where(LABELS == 2, 1, np.where(LABELS > 2, LABELS - 1, LABELS)))
    known.merge(0, 1)
    rest = [0, 2, 3]
    np.testing.assert_allclose(known.inside[rest], merged.inside)
    np.testing.assert_allclose(known.low[rest], merged.low)
    np.testing.assert_allclose(known.high[rest], merged.high)
    borders = [s.TOUCH, s.STEP, s.BEFORE, s.WIDE, s.BENDS, s.BEND, s.CONCAVE, s.LIKE]
    for a, b in ((0, 1), (1, 0), (0, 2), (2, 0), (1, 2)):
        np.testing.assert_allclose(known.between[rest[a], rest[b]][borders], merged.between[a, b][borders])
    assert known.owner.tolist() == [0, 0, 2, 3]


def test_a_copy_is_independent():
    known = of(LABELS)
    before = known.copy()
    known.merge(0, 1)
    assert before.inside[0, s.COUNT] == 300


@pytest.fixture(scope="module")
def occluded():
    return apart(boxes_on_table(((-0.2, 0.05, 0), (0.2, 0.1, 0.1)), ((-0.03, -0.1, 0), (0.03, -0.05, 0.25))))


def test_features_do_not_depend_on_the_order(occluded):
    known = occluded[0].statistics
    a, b = np.nonzero(np.triu(candidates(known)))
    rows = features(known, a, b)
    assert rows.shape == (len(a), len(NAMES))
    assert np.isfinite(rows).all()
    np.testing.assert_array_equal(rows, features(known, b, a))


def test_what_is_parted_by_something_in_front_may_be_one(occluded):
    parts, owner = occluded
    middles = parts.statistics.inside[:, s.POINT][:, 0] / parts.statistics.inside[:, s.COUNT]
    left, right = (np.flatnonzero((owner == 1) & side) for side in (middles < 0, middles > 0))
    assert left.size
    assert right.size
    assert candidates(parts.statistics)[np.ix_(left, right)].any()


def test_sums_of_points_squares_normals_and_colours():
    rng = np.random.default_rng(0)
    points = rng.uniform(0.5, 1.5, POINTS.shape).astype(np.float32)
    normals, shades = rng.normal(size=(2, *POINTS.shape)).astype(np.float32)
    normals[:, 0, 0] = np.nan  # of no normal nothing is added
    upright = s.Upright(np.array([[0.0, 1, 0], [0, 0, 1], [-1, 0, 0]]), np.array([0.3]))
    known = s.statistics(LABELS, points, normals, shades, upright)
    for label in range(1, 5):
        here = label == LABELS
        x, y, z = points[:, here]
        row = known.inside[label - 1]
        assert row[s.COUNT] == here.sum()
        assert row[s.POINT] == pytest.approx(points[:, here].sum(axis=1), rel=1e-5)
        squares = [(a * b).sum() for a, b in ((x, x), (y, y), (z, z), (x, y), (x, z), (y, z))]
        assert row[s.SQUARES] == pytest.approx(squares, rel=1e-5)
        assert row[s.NORMAL] == pytest.approx(np.nansum(normals[:, here], axis=1), rel=1e-3, abs=1e-3)
        assert row[s.SHADE] == pytest.approx(shades[:, here].sum(axis=1), rel=1e-3, abs=1e-3)
        assert row[s.SHADES] == pytest.approx((shades[1:, here] ** 2).sum(), rel=1e-5)
        assert known.low[label - 1] == pytest.approx([y.min(), z.min(), -x.max()])
        assert known.high[label - 1] == pytest.approx([y.max(), z.max(), -x.min()])
    assert known.supports.tolist() == [0.3]
    assert known.owner.tolist() == [0, 1, 2, 3]


def by_hand(labels, points, normals, shades, shifts, told):
    """Return sums over pairs of shifted cells of two patches, in both directions."""
    count = labels.max()
    sums = np.zeros(
        (count, count, len(told(0, 0, 0, 0, points[:, 0, 0], points[:, 0, 0], *[np.zeros(3)] * 4)))
    )
    height, width = labels.shape
    for row in range(height):
        for column in range(width):
            for down, right in shifts:
                r, c = row + down, column + right
                if not (0 <= r < height and 0 <= c < width):
                    continue
                a, b = labels[row, column], labels[r, c]
                if a and b and a != b:
                    of = [f[:, i, j] for f in (points, normals, shades) for i, j in ((row, column), (r, c))]
                    values = told(row, column, r, c, *of)
                    sums[a - 1, b - 1] += values
                    sums[b - 1, a - 1] += values
    return sums


def scene():
    """Return two slopes, a step and an area without a patch, with many colours."""
    rng = np.random.default_rng(1)
    points = POINTS.copy()
    points[2] = 1.0 + 0.4 * np.abs(points[0] - 0.2) + rng.normal(0.0, 0.003, points[2].shape)
    points[2, 10:20, 30:] -= 0.1
    normals = rng.normal(size=points.shape).astype(np.float32)
    normals /= np.linalg.norm(normals, axis=0)
    shades = rng.uniform(size=points.shape).astype(np.float32)
    labels = LABELS.copy()
    labels[5:12, 12:16] = 0
    return labels, points, normals, shades


def test_borders_of_cells_side_by_side_are_where_depth_steps_and_one_is_before_the_other():
    labels, points, normals, shades = scene()
    known = s.statistics(labels, points, normals, shades, UPRIGHT)

    def told(row, column, r, c, p, q, *rest):
        return np.array([1.0, abs(p[2] - q[2]) > 0.007 * max(p[2], p[2] ** 2)])

    sums = by_hand(labels, points, normals, shades, [(0, 1), (1, 0)], told)
    assert known.between[..., s.TOUCH] == pytest.approx(sums[..., 0])
    assert known.between[..., s.STEP] == pytest.approx(sums[..., 1])
    before = known.between[..., s.BEFORE]
    assert before + before.T == pytest.approx(sums[..., 1])
    assert before[3, 1] == sums[3, 1, 1] > 0


def test_borders_of_cells_four_apart_bend_and_differ_in_colour():
    labels, points, normals, shades = scene()
    known = s.statistics(labels, points, normals, shades, UPRIGHT)
    sines = np.sin(np.radians([20, 45]))

    def told(row, column, r, c, p, q, m, n, here, there):
        apart = q - p
        bend = (n - m) @ apart / max(np.linalg.norm(apart), 1e-6)
        near = abs(apart[2]) < 0.02 * max(1, p[2] ** 2)
        differs = np.abs(here - there)
        signs = [bend, bend < -sines[0], bend < -sines[1], bend > sines[1], m @ n]
        return np.array(
            [1.0, near, *(near * np.array([*signs, differs[0], np.hypot(differs[1], differs[2])]))], float
        )

    sums = by_hand(labels, points, normals, shades, [(0, 4), (4, 0), (3, 3), (3, -3)], told)
    columns = [s.WIDE, s.BENDS, s.BEND, s.CONCAVE, s.DEEP, s.CONVEX, s.LIKE, s.BRIGHTER, s.COLOURED]
    for column, name in enumerate(columns):
        assert known.between[..., name] == pytest.approx(sums[..., column], rel=1e-3, abs=1e-3), name


def test_what_stands_between_two_patches_is_nearer_or_farther():
    labels = np.zeros((3, 36), np.int32)
    labels[:, :12], labels[:, 24:] = 1, 2
    points = np.ones((3, 3, 36), np.float32)
    points[2, :, 12:18], points[2, :, 18:24] = 0.5, 2.0
    known = s.statistics(labels, points, np.zeros_like(points), np.zeros_like(points), UPRIGHT)
    sight, blocked, open_ = (known.between[0, 1, n] for n in (s.SIGHT, s.BLOCKED, s.OPEN))
    assert (sight, blocked, open_) == (6, 3, 3)
    assert (known.between[1, 0, [s.SIGHT, s.BLOCKED, s.OPEN]] == [6, 3, 3]).all()
    level = np.ones_like(points)
    known = s.statistics(labels, level, np.zeros_like(points), np.zeros_like(points), UPRIGHT)
    assert known.between[0, 1, [s.SIGHT, s.BLOCKED, s.OPEN]].tolist() == [6, 0, 0]


def test_cells_are_hidden_by_each_side_at_which_something_else_is_nearer():
    labels = np.zeros((5, 5), np.int32)
    labels[2, 2] = 1
    points = np.ones((3, 5, 5), np.float32)
    for nearer, hidden in (([], 0), ([(1, 2)], 1), ([(1, 2), (3, 2), (2, 1), (2, 3)], 4), ([(1, 1)], 0)):
        here = points.copy()
        for row, column in nearer:
            here[2, row, column] = 0.9
        known = s.statistics(labels, here, np.zeros_like(here), np.zeros_like(here), UPRIGHT)
        assert known.inside[0, s.HIDDEN] == hidden
    behind = points.copy()
    behind[2, 2, 2] = 0.9
    known = s.statistics(labels, behind, np.zeros_like(points), np.zeros_like(points), UPRIGHT)
    assert known.inside[0, s.HIDDEN] == 0


def test_without_patches_there_are_no_sums_and_a_copy_is_its_own():
    nothing = of(np.zeros_like(LABELS))
    assert nothing.inside.shape == (0, s.INSIDE)
    assert nothing.low.shape == (0, 3)
    known = of(LABELS)
    other = known.copy()
    other.merge(0, 1)
    assert known.owner.tolist() == [0, 1, 2, 3]
    assert other.owner.tolist() == [0, 0, 2, 3]
    other.merge(2, 0)
    assert other.owner.tolist() == [2, 2, 2, 3]
