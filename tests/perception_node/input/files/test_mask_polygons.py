"""Conversion of polygons to column-wise runs."""

import numpy as np
import pytest

from semmap.nodes.perception_node.input.files.mask_polygons import counts_of


def mask(polygons, height=6, width=8):
    counts = counts_of(polygons, height, width)
    assert sum(counts) == height * width
    values = np.repeat(np.arange(len(counts)) % 2, counts)
    return values.reshape(width, height).T.astype(bool)


def boxed(top, bottom, left, right, height=6, width=8):
    expected = np.zeros((height, width), bool)
    expected[top:bottom, left:right] = True
    return expected


def test_a_rectangle_covers_the_pixels_whose_middles_are_within():
    assert (mask([[2, 1, 5, 1, 5, 4, 2, 4]]) == boxed(1, 4, 2, 5)).all()
    assert (mask([[2.4, 0.6, 5.4, 0.6, 5.4, 3.4, 2.4, 3.4]]) == boxed(1, 3, 2, 5)).all()
    assert (mask([[2.6, 0.4, 5.6, 0.4, 5.6, 3.6, 2.6, 3.6]]) == boxed(0, 4, 3, 6)).all()


def test_the_first_run_is_of_what_is_not_masked():
    assert counts_of([[0, 0, 2, 0, 2, 2, 0, 2]], 2, 3) == [0, 4, 2]
    assert counts_of([[1, 0, 3, 0, 3, 2, 1, 2]], 2, 3) == [2, 4, 0]
    assert counts_of([], 2, 3) == [6]


def test_a_triangle_is_half_of_its_box():
    found = mask([[0, 0, 8, 0, 0, 8]], 8, 8)
    row, column = np.indices((8, 8))
    assert (found | (row + column + 1 >= 8)).all()
    assert not (found & (row + column + 1 > 8)).any()
    assert found[0, :7].all()
    assert not found[7, 1:].any()


def test_slanted_edges_cut_rows_anywhere():
    row, column = np.indices((10, 12)) + 0.5
    rhombus = abs(column - 7.2) / 4 + abs(row - 5.1) / 3 < 1
    assert (mask([[7.2, 2.1, 11.2, 5.1, 7.2, 8.1, 3.2, 5.1]], 10, 12) == rhombus).all()


def test_what_a_polygon_leaves_out_is_out():
    u = [0, 0, 8, 0, 8, 6, 6, 6, 6, 2, 2, 2, 2, 6, 0, 6]
    expected = boxed(0, 2, 0, 8) | boxed(0, 6, 0, 2) | boxed(0, 6, 6, 8)
    assert (mask([u]) == expected).all()


def test_several_polygons_are_one_mask():
    found = mask([[0, 0, 2, 0, 2, 2, 0, 2], [5, 3, 8, 3, 8, 6, 5, 6]])
    assert (found == (boxed(0, 2, 0, 2) | boxed(3, 6, 5, 8))).all()


def test_what_is_beyond_the_picture_is_cut():
    assert (mask([[-5, -5, 3, -5, 3, 3, -5, 3]]) == boxed(0, 3, 0, 3)).all()
    assert (mask([[5, 4, 50, 4, 50, 40, 5, 40]]) == boxed(4, 6, 5, 8)).all()


@pytest.mark.parametrize("polygon", [[], [0, 0, 1, 1], [0, 0, 1, 1, 2], [0, 0, 1, 1, 2, "2"], "012345", None])
def test_what_is_no_polygon_is_told(polygon):
    with pytest.raises(ValueError, match="at least three corners"):
        counts_of([polygon], 4, 4)


@pytest.mark.parametrize("x", [1.1e6, -1.1e6])
def test_a_corner_far_beyond_the_picture_is_told(x):
    with pytest.raises(ValueError, match="far outside the image"):
        counts_of([[0, 0, x, 0, 1, 1]], 4, 4)
    assert counts_of([[0, 0, 0.9e6, 0, 0, 4]], 4, 4)
