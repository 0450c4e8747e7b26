"""Features of pairs of patches: two blocks of cells with known positions and colours."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from semmap.nodes.perception_node.segmentation import statistics as s
from semmap.nodes.perception_node.segmentation.pairs import NAMES, candidates, features

PLAIN_BORDER = {
    s.TOUCH: 10.0,
    s.STEP: 0.5,
    s.WIDE: 20.0,
    s.BENDS: 5.0,
    s.BEND: 2.0,
    s.CONCAVE: 1.0,
    s.DEEP: 3.0,
    s.CONVEX: 4.0,
    s.LIKE: 2.5,
    s.SIGHT: 8.0,
    s.BLOCKED: 2.0,
    s.OPEN: 6.0,
    s.BRIGHTER: 50.0,
    s.COLOURED: 25.0,
}


def block(low, high, steps, normal=(0.0, 0.0, 1.0), shade=(100.0, 0.0, 0.0), hidden=0.0):
    """Return points that fill a box, with one normal and one colour."""
    axes = [np.linspace(a, b, n) for a, b, n in zip(low, high, steps, strict=True)]
    points = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 3)
    return SimpleNamespace(
        points=points, low=np.array(low), high=np.array(high), normal=normal, shade=shade, hidden=hidden
    )


def statistics(*blocks, border=PLAIN_BORDER, before=(0.0, 0.0), supports=()):
    width = 1 + max(_columns())
    inside = np.zeros((len(blocks), width))
    for row, one in enumerate(blocks):
        p, count = one.points, len(one.points)
        inside[row, s.COUNT] = count
        inside[row, s.POINT] = p.sum(axis=0)
        x, y, z = p.T
        inside[row, s.SQUARES] = [(a * b).sum() for a, b in ((x, x), (y, y), (z, z), (x, y), (x, z), (y, z))]
        inside[row, s.NORMAL] = count * np.array(one.normal)
        inside[row, s.SHADE] = count * np.array(one.shade)
        inside[row, s.SHADES] = count * (one.shade[1] ** 2 + one.shade[2] ** 2 + 9.0)
        inside[row, s.HIDDEN] = one.hidden
    between = np.zeros((len(blocks), len(blocks), 1 + max(_border_columns())))
    for key, value in border.items():
        between[..., key] = value
    between[0, 1, s.BEFORE], between[1, 0, s.BEFORE] = before
    return SimpleNamespace(
        inside=inside,
        between=between,
        low=np.array([one.low for one in blocks]),
        high=np.array([one.high for one in blocks]),
        supports=np.array(supports, float),
    )


def _ends(columns):
    return [c.stop - 1 if isinstance(c, slice) else c for c in columns]


def _columns():
    return _ends([s.COUNT, s.POINT, s.SQUARES, s.NORMAL, s.SHADE, s.SHADES, s.HIDDEN])


def _border_columns():
    return _ends([*PLAIN_BORDER, s.BEFORE])


SMALL = block((0.0, 0.0, 0.1), (0.1, 0.2, 0.3), (3, 3, 3), shade=(100.0, 3.0, 4.0), hidden=5.4)
BIG = block((0.3, 0.0, 0.0), (0.7, 0.4, 0.2), (6, 5, 4), (0.6, 0.0, 0.0), shade=(160.0, 0.0, 0.0))


def told(*blocks, a=0, b=1, **how):
    (row,) = features(statistics(*blocks or (SMALL, BIG), **how), np.array([a]), np.array([b]))
    return dict(zip(NAMES, row.tolist(), strict=True))


def test_there_is_one_number_for_each_name_whichever_patch_stands_first():
    one, other = told(before=(3.0, 7.0)), told(before=(3.0, 7.0), a=1, b=0)
    assert len(one) == len(NAMES)
    assert one == other
    equal = block((1.0, 0.0, 0.0), (1.1, 0.2, 0.3), (3, 3, 3))
    assert told(SMALL, equal) == told(SMALL, equal, a=1, b=0)


def test_sizes_in_cells():
    found = told()
    assert found["log_small"] == pytest.approx(math.log(27))
    assert found["log_big"] == pytest.approx(math.log(120))
    assert found["ratio"] == pytest.approx(27 / 120)


def test_what_is_along_the_border():
    found, root = told(before=(3.0, 7.0)), math.sqrt(27)
    assert found["touch"] == pytest.approx(10.0 / root)
    assert found["step"] == pytest.approx(0.05)
    assert (found["small_before"], found["big_before"]) == pytest.approx((0.3, 0.7))
    assert found["wide"] == pytest.approx(20.0 / root)
    assert found["bends"] == pytest.approx(5.0 / 20.0)
    shares = [found[name] for name in ("bend", "concave", "deep", "convex", "like")]
    assert shares == pytest.approx([0.4, 0.2, 0.6, 0.8, 0.5])
    assert found["sight"] == 8.0
    assert (found["blocked"], found["open"]) == pytest.approx((0.25, 0.75))


def test_without_a_border_nothing_is_divided_by_nothing():
    found = told(border=dict.fromkeys(PLAIN_BORDER, 0.0))
    assert all(math.isfinite(value) for value in found.values())
    assert found["brighter_there"] == found["coloured_there"] == -1.0


def test_how_flat_and_long_they_are_alone_and_together():
    found = told()

    def spread(*blocks):
        return np.sqrt(np.linalg.eigvalsh(np.cov(np.concatenate([b.points for b in blocks]).T, bias=True)))

    assert found["flat_small"] == pytest.approx(spread(SMALL)[0], rel=1e-4)
    assert found["flat_big"] == pytest.approx(spread(BIG)[0], rel=1e-4)
    assert found["flat_both"] == pytest.approx(spread(SMALL, BIG)[0], rel=1e-4)
    flattest = max(spread(SMALL)[0], spread(BIG)[0])
    assert found["flatter"] == pytest.approx(spread(SMALL, BIG)[0] - flattest, rel=1e-3)
    assert found["long_both"] == pytest.approx(spread(SMALL, BIG)[2], rel=1e-4)


def test_which_way_they_face():
    found = told()
    assert (found["curved_small"], found["curved_big"]) == pytest.approx((1.0, 0.6))
    assert found["facing"] == pytest.approx(0.0)
    apart = np.array([0.5, 0.2, 0.1]) - np.array([0.05, 0.1, 0.2])
    assert found["off_big"] == pytest.approx(apart[0], abs=1e-6)
    assert found["off_small"] == pytest.approx(-apart[2], abs=1e-6)
    assert found["turned_out"] == pytest.approx(
        np.dot(np.array([0.6, 0.0, -1.0]), apart) / np.linalg.norm(apart), abs=1e-6
    )
    assert found["apart"] == pytest.approx(np.linalg.norm(apart))


def test_how_high_they_are_and_whether_one_stands_on_the_other():
    found = told()
    assert (found["tall_small"], found["tall_big"]) == pytest.approx((0.2, 0.2))
    assert (found["low_small"], found["low_big"]) == (0.0, 0.0)  # nothing carries anything
    assert found["small_on_big"] == pytest.approx(0.1 - 0.2)
    assert found["big_on_small"] == pytest.approx(0.0 - 0.3)
    assert found["levels"] == pytest.approx(0.2 - 0.1)
    assert (found["tops_apart"], found["bottoms_apart"]) == pytest.approx((0.1, 0.1))


def test_how_high_they_are_above_what_carries_them():
    found = told(supports=(-0.5, 0.05, 0.11))
    assert found["low_small"] == pytest.approx(0.1 - 0.11)
    assert found["low_big"] == pytest.approx(0.5)
    assert told(supports=(0.5,))["low_big"] == pytest.approx(-0.5)  # below all: above the lowest


def test_how_large_they_are_together_and_how_much_of_that_they_fill():
    found = told()
    assert (found["side_both"], found["width_both"], found["tall_both"]) == pytest.approx((0.7, 0.4, 0.3))
    assert found["filled"] == pytest.approx((0.02 + 0.16) / 0.28)
    assert found["footprint"] == pytest.approx(0.02 / 0.16)


def test_how_unlike_their_colours_are():
    found = told()
    assert found["brighter"] == pytest.approx(60.0)
    assert found["coloured"] == pytest.approx(5.0)
    assert (found["brighter_there"], found["coloured_there"]) == pytest.approx((10.0, 5.0))
    assert (found["mottled_small"], found["mottled_big"]) == pytest.approx((3.0, 3.0))
    grey = block((0.0, 0.0, 0.1), (0.1, 0.2, 0.3), (3, 3, 3), shade=(math.nan,) * 3)
    unknown = told(grey, BIG)
    assert (unknown["brighter"], unknown["coloured"], unknown["mottled_small"]) == (-1.0, -1.0, -1.0)


def test_what_is_hidden_counts_by_the_root_of_the_cells():
    found = told()
    assert (found["hidden_small"], found["hidden_big"]) == pytest.approx((5.4 / math.sqrt(27), 0.0))


@pytest.mark.parametrize(
    ("border", "x", "may"),
    [
        ({s.WIDE: 1.0}, 5.0, True),
        ({s.TOUCH: 1.0}, 5.0, True),
        ({}, 0.1, False),
        ({s.BLOCKED: 1.0}, 0.34, True),
        ({s.BLOCKED: 1.0}, 0.36, False),
        ({s.BLOCKED: 2.0, s.OPEN: 1.0}, 0.1, True),
        ({s.BLOCKED: 1.0, s.OPEN: 1.0}, 0.1, False),
    ],
)
def test_pairs_may_be_one_if_they_touch_or_are_near_and_parted_by_something(border, x, may):
    found = candidates(statistics(*blocks_apart(x), border=dict.fromkeys(PLAIN_BORDER, 0.0) | border))
    assert found.tolist() == [[False, may], [may, False]]


def test_the_reach_of_pairs_that_something_parts_can_be_chosen():
    border = dict.fromkeys(PLAIN_BORDER, 0.0) | {s.BLOCKED: 1.0}
    assert candidates(statistics(*blocks_apart(0.36), border=border), 9.0).any()


def blocks_apart(x):
    one = block((0.0, 0.0, 0.0), (0.1, 0.1, 0.1), (2, 2, 2))
    return one, block((x, 0.0, 0.0), (x + 0.1, 0.1, 0.1), (2, 2, 2))
