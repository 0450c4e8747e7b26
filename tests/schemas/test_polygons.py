import math
import random

import pytest

from semmap.schemas.errors import BadRequest
from semmap.schemas.polygons import MOST_POINTS, box_around, read_wkt, signed_area, simple, wkt

L_SHAPE = "POLYGON ((0 0, 4 0, 4 1, 1 1, 1 3, 0 3, 0 0))"
WITH_HOLE = "POLYGON ((0 0, 4 0, 4 4, 0 4, 0 0), (1 1, 1 2, 2 2, 2 1, 1 1))"


@pytest.mark.parametrize("text", [L_SHAPE, WITH_HOLE])
def test_what_is_read_is_written_the_same(text):
    assert wkt(read_wkt(text)) == text


def test_borders_are_turned_as_usual_and_points_that_repeat_are_dropped():
    polygon = read_wkt("polygon((0 0,0 3,0 3, 1 3,1 1,4 1,4 0,0 0))")

    assert signed_area(polygon.outer) == pytest.approx(6.0)
    assert len(polygon.outer) == 6
    assert read_wkt(WITH_HOLE).area_m2 == pytest.approx(15.0)
    assert signed_area(read_wkt(WITH_HOLE).holes[0]) < 0.0


def test_what_it_contains():
    polygon = read_wkt(WITH_HOLE)

    assert polygon.contains((0.5, 0.5))
    assert not polygon.contains((1.5, 1.5))
    assert not polygon.contains((5.0, 1.0))
    assert polygon.bounds == (0.0, 0.0, 4.0, 4.0)
    assert box_around(polygon, 0.5, 2.4) == ((2.0, 2.0, 0.5), (4.0, 4.0, 2.4))


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("POLYGON ((0 0, 4 4, 4 0, 0 4, 0 0))", "crosses or touches itself"),
        ("POLYGON ((0 0, 4 0, 4 4, 2 0, 0 4, 0 0))", "crosses or touches itself"),
        ("POLYGON ((0 0, 4 0, 2 0, 2 4, 0 0))", "crosses or touches itself"),
        ("POLYGON ((0 0, 4 0, 4 4, 0 4))", "not closed"),
        ("POLYGON ((0 0, 4 0, 4 nan, 0 0))", "within 10000 m"),
        ("POLYGON ((0 0, 4 0, 4 inf, 0 0))", "within 10000 m"),
        ("POLYGON ((0 0, 4 0, 4 1e9, 0 0))", "within 10000 m"),
        ("POLYGON ((0 0, 4 0 1, 4 4, 0 0))", "two numbers"),
        ("POLYGON ((0 0, 4 x, 4 4, 0 0))", "two numbers"),
        ("POLYGON ((0 0, 1 1, 2 2, 0 0))", "no area"),
        ("POLYGON ((0 0, 0 0))", "no area"),
        ("POLYGON (())", "two numbers"),
        ("POLYGON EMPTY", "one POLYGON"),
        ("POINT (1 2)", "not POINT"),
        ("MULTIPOLYGON (((0 0, 1 0, 1 1, 0 0)))", "not MULTIPOLYGON"),
        ("<http://www.opengis.net/def/crs/OGC/1.3/CRS84> POLYGON ((0 0, 1 0, 1 1, 0 0))", "reference system"),
        ("", "nothing"),
        ("POLYGON ((0 0, 1 0, 1 1, 0 0)", "parentheses|one POLYGON"),
        ("POLYGON ((0 0, 1 0, 1 1, 0 0) (0 0, 1 0, 1 1, 0 0))", "separated by commas"),
        ("POLYGON ((0 0, 4 0, 4 4, 0 4, 0 0), (5 5, 6 5, 6 6, 5 5))", "outside of its outer"),
        ("POLYGON ((0 0, 4 0, 4 4, 0 4, 0 0), (1 1, 5 1, 2 2, 1 1))", "two borders"),
        (
            "POLYGON ((0 0, 9 0, 9 9, 0 9, 0 0), (1 1, 5 1, 5 5, 1 5, 1 1), (2 2, 3 2, 3 3, 2 2))",
            "another hole",
        ),
    ],
)
def test_polygons_that_are_not_simple_are_rejected_with_the_reason(text, said):
    with pytest.raises(BadRequest, match=said):
        read_wkt(text)


def test_too_many_corners():
    count = MOST_POINTS + 1
    ring = [
        (math.cos(2 * math.pi * k / count) * 5, math.sin(2 * math.pi * k / count) * 5) for k in range(count)
    ]

    with pytest.raises(BadRequest, match=f"has {count} corners; the maximum is {MOST_POINTS}"):
        simple([ring])
    assert len(simple([ring[1:]]).outer) == MOST_POINTS


def test_random_polygons_are_simple_just_when_no_two_edges_cross():
    chance = random.Random(7)
    outcomes = []
    for _ in range(300):
        ring = [(chance.uniform(0, 9), chance.uniform(0, 9)) for _ in range(chance.randint(4, 7))]
        edges = list(zip(ring, ring[1:] + ring[:1], strict=True))
        crossed = any(
            crosses(*one, *other)
            for k, one in enumerate(edges)
            for other in edges[k + 2 :]
            if one[0] != other[1]
        )
        try:
            polygon = simple([ring])
        except BadRequest:
            outcomes.append((crossed, True))
        else:
            outcomes.append((crossed, False))
            assert read_wkt(wkt(polygon)) == polygon
    assert all(crossed == refused for crossed, refused in outcomes)
    assert {crossed for crossed, _ in outcomes} == {True, False}


def crosses(a, b, c, d):
    def side(p, q, r):
        return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])

    return side(a, b, c) * side(a, b, d) < 0 and side(c, d, a) * side(c, d, b) < 0
