import math
import random

import pytest

from semmap.nodes.geometry.polygons import area
from semmap.nodes.geometry.regions import Region
from semmap.schemas.polygons import read_wkt

L_SHAPE = read_wkt("POLYGON ((0 0, 4 0, 4 1, 1 1, 1 3, 0 3, 0 0))")
WITH_HOLE = read_wkt("POLYGON ((0 0, 4 0, 4 4, 0 4, 0 0), (1 1, 1 2, 2 2, 2 1, 1 1))")


def square(x, y, half):
    return [(x - half, y - half), (x + half, y - half), (x + half, y + half), (x - half, y + half)]


def test_pieces_make_up_the_polygon():
    for polygon in (L_SHAPE, WITH_HOLE):
        region = Region(polygon.rings)
        assert region.area == pytest.approx(polygon.area_m2)
        assert all(area(piece.corners) > 0.0 for piece in region.pieces)
    assert len(Region(L_SHAPE.rings).pieces) == 2
    assert len(Region(WITH_HOLE.rings).pieces) == 4


def test_shared_areas():
    region = Region(L_SHAPE.rings)

    assert region.shared(square(0.5, 0.5, 0.25), (0.0, 0.0)) == pytest.approx(0.25)
    assert region.shared(square(2.0, 2.0, 0.5), (0.0, 0.0)) == 0.0
    assert region.shared(square(1.0, 1.0, 0.5), (0.0, 0.0)) == pytest.approx(0.75)
    assert region.shared(square(101.0, 51.0, 0.5), (100.0, 50.0)) == pytest.approx(0.75)
    assert Region(WITH_HOLE.rings).shared(square(1.5, 1.5, 1.0), (0.0, 0.0)) == pytest.approx(3.0)


def test_contains_and_distance():
    region = Region(WITH_HOLE.rings)

    assert region.contains((0.5, 1.5))
    assert not region.contains((1.5, 1.5))
    assert region.distance(square(1.5, 1.5, 0.1), (0.0, 0.0)) == pytest.approx(0.4)
    assert region.distance(square(5.0, 2.0, 0.5), (0.0, 0.0)) == pytest.approx(0.5)
    assert Region(L_SHAPE.rings).distance(square(3.0, 2.5, 0.5), (0.0, 0.0)) == pytest.approx(1.0)


def test_random_stars_against_counted_points():
    chance = random.Random(3)
    for _ in range(20):
        count = chance.randint(5, 30)
        ring = [
            (
                (r := chance.uniform(1.0, 3.0)) * math.cos(2 * math.pi * k / count),
                r * math.sin(2 * math.pi * k / count),
            )
            for k in range(count)
        ]
        region = Region([ring])
        assert region.area == pytest.approx(area(ring))
        corners = square(chance.uniform(-2, 2), chance.uniform(-2, 2), 0.5)
        share = region.shared(corners, (0.0, 0.0))
        (x0, y0), _, (x1, y1), _ = corners
        points = [
            (x0 + (x1 - x0) * (i + 0.5) / 60, y0 + (y1 - y0) * (j + 0.5) / 60)
            for i in range(60)
            for j in range(60)
        ]
        assert share == pytest.approx(sum(map(region.contains, points)) / 3600, abs=0.01)
