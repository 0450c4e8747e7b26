"""Polygons as triangles."""

import numpy as np
import pytest

from semmap.nodes.drawing.triangulation import triangles_of
from semmap.schemas.polygons import read_wkt

L = "POLYGON ((2 1, 6 1, 6 3, 4 3, 4 5, 2 5, 2 1))"
HOLED = "POLYGON ((0 0, 4 0, 4 4, 0 4, 0 0), (1 1, 1 2, 2 2, 2 1, 1 1))"
TURNED = "POLYGON ((0 0, 3 1, 2 4, -1 3, 0 0))"


@pytest.mark.parametrize("text", [L, HOLED, TURNED])
def test_triangles_cover_the_polygon_and_no_more(text):
    polygon = read_wkt(text)
    points, triangles = triangles_of(polygon)
    a, b, c = (points[triangles[:, k]].astype(float) for k in range(3))
    areas = ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]) / 2.0
    assert (areas > 0.0).all()  # counterclockwise: seen from above
    assert areas.sum() == pytest.approx(polygon.area_m2)
    x0, y0, x1, y1 = polygon.bounds
    middles = (a + b + c) / 3.0 + ((x0 + x1) / 2.0, (y0 + y1) / 2.0)
    assert all(polygon.contains(tuple(middle)) for middle in middles.tolist())


def test_corners_are_around_the_middle_of_the_bounds():
    points, _ = triangles_of(read_wkt(L))
    assert np.allclose(points.min(axis=0), (-2.0, -2.0))
    assert np.allclose(points.max(axis=0), (2.0, 2.0))
