import numpy as np
import pytest

from semmap.nodes.perception_node.recognition.features import SORTS, features_of
from semmap.nodes.perception_node.views.merged_thing import thing_of
from semmap.nodes.perception_node.views.segments import Segment
from semmap.nodes.perception_node.views.supports import Support

TRIMMED = slice(22, None)
"""The columns of `geometry` that leave 3 % of the cells and more out at each end."""


def block(*corners_m):
    """Return a thing that fills boxes (low, high) with points every 8 mm."""
    grids = [np.meshgrid(*(np.arange(a, b, 0.008) for a, b in zip(*of, strict=True))) for of in corners_m]
    points = np.concatenate([np.stack(grid, axis=-1).reshape(-1, 3) for grid in grids]).astype(np.float32)
    segment = Segment(
        points, np.full(points.shape, 90, np.uint8), 1, np.array([1.0, 0.0, 1.0]), False, len(points)
    )
    return thing_of([segment], [Support(0.0)])


ALONE = block(((0.0, 0.0, 0.0), (0.2, 0.1, 0.1)))
WITH_A_SCRAP = block(((0.0, 0.0, 0.0), (0.2, 0.1, 0.1)), ((0.2, 0.04, 0.04), (0.3, 0.05, 0.05)))


def test_one_row_a_thing_for_each_sort():
    features = features_of([ALONE, WITH_A_SCRAP])
    assert [len(of) for of in features] == [2] * len(SORTS)
    assert all(np.isfinite(of).all() for of in features)


def test_a_scrap_of_the_neighbour_hardly_changes_what_is_trimmed():
    alone, with_a_scrap = features_of([ALONE, WITH_A_SCRAP])[0]
    assert with_a_scrap[0] - alone[0] > 0.3
    assert with_a_scrap[TRIMMED] == pytest.approx(alone[TRIMMED], abs=0.05)


def named(thing, sort):
    return features_of([thing])[SORTS.index(sort)][0]


def inside(thing):
    """Return the cells (N, 3) of an upright, unrotated thing in its box."""
    return np.clip((thing.cells - thing.box.low) / thing.box.size_m, 0.0, 1.0)


def painted(rgb_of):
    points = block(((0.0, 0.0, 0.0), (0.2, 0.1, 0.1))).segments[0].points
    colors = np.array([rgb_of(*point) for point in points / points.max(axis=0)], np.uint8)
    return thing_of(
        [Segment(points, colors, 1, np.array([1.0, 0.0, 1.0]), False, len(points))], [Support(0.0)]
    )


def test_geometry_begins_with_the_box_and_how_it_was_seen():
    found = named(ALONE, "geometry")
    long, short, high = ALONE.box.size_m
    assert found[:6] == pytest.approx(
        np.log([long, short, high, long / short, high / long, (long * short * high) ** (1 / 3)])
    )
    assert found[6] == pytest.approx(ALONE.lifted_m / high)
    assert found[7] == pytest.approx(1.0)  # the whole footprint
    cells = inside(ALONE)
    assert found[8] == pytest.approx(np.mean(cells[:, 2] > 0.9))
    assert found[9] == pytest.approx(np.mean(cells[:, 2] < 0.3))
    assert found[10:13] == pytest.approx(cells.std(axis=0))
    assert found[13] == pytest.approx(np.mean(np.abs(cells[:, :2] - 0.5).max(axis=1) > 0.4))
    to_eye = np.array([1.0, 0.0, 1.0]) - (ALONE.box.low + ALONE.box.high) / 2
    assert found[14] == 0.0  # one eye
    assert found[15] == pytest.approx(np.linalg.norm(to_eye))
    assert found[16] == pytest.approx(to_eye[2] / np.linalg.norm(to_eye))
    assert found[17] == 0.0  # whole
    assert found[18] == pytest.approx(np.log(ALONE.count))


def test_geometry_ends_with_what_is_left_when_its_ends_are_trimmed():
    found, cells = named(ALONE, "geometry"), inside(ALONE)
    long, short, high = ALONE.box.size_m
    for row, share in enumerate((0.01, 0.03, 0.08, 0.2)):
        low, top = np.quantile(cells, share, axis=0), np.quantile(cells, 1.0 - share, axis=0)
        expected = np.log([(top[0] - low[0]) * long, (top[1] - low[1]) * short, top[2] * high])
        assert found[19 + 3 * row : 22 + 3 * row] == pytest.approx(expected, abs=1e-6)
        assert found[31 + row] == pytest.approx(low[2], abs=1e-9)


def test_a_thing_that_lies_across_is_described_like_one_that_lies_along():
    across = block(((0.0, 0.0, 0.0), (0.1, 0.2, 0.1)))
    one, other = named(ALONE, "geometry"), named(across, "geometry")
    assert other[:14] == pytest.approx(one[:14], abs=0.02)
    assert other[19:] == pytest.approx(one[19:], abs=0.02)


def test_shape_tells_how_wide_a_thing_is_at_each_height():
    cone = block(
        *(
            (
                (0.1 * k / 8, 0.05 * k / 8, 0.0125 * k),
                (0.2 - 0.1 * k / 8, 0.1 - 0.05 * k / 8, 0.0125 * k + 0.008),
            )
            for k in range(8)
        )
    )
    found, cells = named(cone, "shape"), inside(cone)
    long, short = np.sort(cone.box.size_m[:2])[::-1]
    offset = (cells[:, :2] - 0.5) * (long, short) / np.sqrt(long * short)
    radius, level = np.hypot(*offset.T), np.minimum((cells[:, 2] * 8).astype(int), 7)
    ring = np.minimum((radius / 0.75 * 5).astype(int), 4)
    for k in range(8):
        here = level == k
        assert found[k] == pytest.approx(here.mean())
        assert found[8 + k] == pytest.approx(radius[here].mean() if here.any() else 0.0)
        assert found[16 + k] == pytest.approx((radius[here] ** 2).mean() if here.any() else 0.0)
        span = np.ptp(offset[here], axis=0) if here.any() else (0.0, 0.0)
        assert found[24 + 2 * k : 26 + 2 * k] == pytest.approx(span)
    for k in range(5):
        assert found[40 + k] == pytest.approx((ring == k).mean())
        assert found[45 + k] == pytest.approx(cells[ring == k, 2].max(initial=0.0))


def test_shape_ends_with_shares_of_distances_between_pairs_of_points():
    found = named(ALONE, "shape")[50:]
    assert len(found) == 10
    assert found.sum() == pytest.approx(1.0)
    two = thing_of(
        [
            Segment(
                np.array([[0.0, 0, 0], [0.5, 0, 0]] * 20, np.float32), None, 1, np.ones(3), False, count=40
            )
        ],
        [Support(0.0)],
    )
    ends = named(two, "shape")[50:]
    assert ends[1:9] == pytest.approx(0.0)  # nothing or all of the way
    assert 0.3 < ends[9] < 0.7


def test_colours_are_shares_of_hues_and_greys_and_means():
    red = named(painted(lambda x, y, z: (255, 0, 0)), "colour")
    assert red[:16] == pytest.approx([1.0] + [0.0] * 15)
    assert red[16:22] == pytest.approx([1, 0, 0, 0, 0, 0])
    assert red[22:34] == pytest.approx([1] * 4 + [0] * 8)
    green = named(painted(lambda x, y, z: (0, 255, 0)), "colour")
    assert green[:12].argmax() == 4
    blue = named(painted(lambda x, y, z: (0, 0, 255)), "colour")
    assert blue[:12].argmax() == 8
    grey = named(painted(lambda x, y, z: (100, 100, 100)), "colour")
    assert grey[:12] == pytest.approx(0.0)
    assert grey[12:16] == pytest.approx([0, 1, 0, 0])
    pale = named(painted(lambda x, y, z: (255, 204, 204)), "colour")
    assert pale[0] == pytest.approx(3 * 0.2 - 0.3, abs=0.01)
    assert pale[15] == pytest.approx(1.0 - pale[0], abs=0.01)
    white = named(painted(lambda x, y, z: (255, 255, 255)), "colour")
    assert white[12:16] == pytest.approx([0, 0, 0, 1])


def test_colours_of_bands_go_from_the_bottom_to_the_top():
    found = named(painted(lambda x, y, z: (255 * (z > 0.5), 0, 255 * (z <= 0.5))), "colour")
    reds, blues = found[22:26], found[30:34]
    assert reds[0] == pytest.approx(0.0)
    assert blues[0] == pytest.approx(1.0)
    assert reds[3] == pytest.approx(1.0)
    assert blues[3] == pytest.approx(0.0)
    assert 0.3 < found[16] < 0.7
    assert 0.4 < found[19] < 0.6  # it varies


def test_without_colours_there_are_zeros():
    points = block(((0.0, 0.0, 0.0), (0.2, 0.1, 0.1))).segments[0].points
    plain = thing_of([Segment(points, None, 1, np.ones(3), False, len(points))], [Support(0.0)])
    assert named(plain, "colour").tolist() == [0.0] * 34
