import math

from hypothesis import given
from hypothesis import strategies as st

from semmap.nodes.geometry.polygons import area, clipped, contains, distance, hull

SQUARE = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
POINTS = st.lists(st.tuples(st.integers(-8, 8), st.integers(-8, 8)), min_size=3, max_size=9)


def moved(polygon, x, y):
    return [(px + x, py + y) for px, py in polygon]


def test_areas():
    assert area(SQUARE) == 1.0
    assert area(clipped(SQUARE, moved(SQUARE, 0.5, 0.5))) == 0.25
    assert clipped(SQUARE, moved(SQUARE, 2.0, 0.0)) == []
    assert area([]) == 0.0


def test_distances():
    assert distance(SQUARE, moved(SQUARE, 3.0, 0.0)) == 2.0
    assert math.isclose(distance(SQUARE, moved(SQUARE, 2.0, 2.0)), math.sqrt(2.0))
    assert distance(SQUARE, moved(SQUARE, 0.5, 0.0)) == 0.0
    assert distance(SQUARE, [(0.4, -1.0), (0.6, -1.0), (0.6, 2.0), (0.4, 2.0)]) == 0.0


@given(POINTS)
def test_a_hull_is_around_its_points(points):
    around = hull(points)
    assert set(around) <= set(points)
    if len(around) > 2:
        assert area(around) > 0.0
        assert all(contains(around, point) for point in points)


@given(POINTS, POINTS)
def test_what_two_have_in_common_is_in_both(one, other):
    a, b = hull(one), hull(other)
    if len(a) > 2 and len(b) > 2:
        both = area(clipped(a, b))
        assert -1e-9 <= both <= min(area(a), area(b)) + 1e-9
        assert math.isclose(both, area(clipped(b, a)), abs_tol=1e-9)
        assert (both > 1e-9) <= (distance(a, b) == 0.0)
