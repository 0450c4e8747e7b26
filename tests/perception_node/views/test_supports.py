import numpy as np
import pytest

from semmap.nodes.perception_node.views.supports import Support, height_below, support_of

TABLE = Support(0.7, (0.0, 0.0), (0.8, 1.4), 1.12)
FLOOR = Support(0.0, (2.0, 2.0), (3.0, 3.0), 1.0)


def height(low, high, *supports):
    return height_below(supports, np.array(low), np.array(high), most_m=low[2] + 0.03, floor_m=-1.0)


def test_a_thing_stands_on_what_is_below_it():
    assert height((0.1, 0.1, 0.71), (0.2, 0.2, 0.8), FLOOR, TABLE) == 0.7
    assert height((0.75, 0.1, 0.71), (0.9, 0.2, 0.8), FLOOR, TABLE) == 0.7  # it juts out
    assert height((1.5, 0.1, 0.71), (1.7, 0.2, 0.9), FLOOR, TABLE) == 0.0  # beside the table
    assert height((0.1, 0.1, 0.5), (0.2, 0.2, 0.6), FLOOR, TABLE) == 0.0  # under it
    assert height((0.1, 0.1, 0.5), (0.2, 0.2, 0.6)) == -1.0


def seats(y, x):
    """Return points (96, 96, 3) 2.5 cm apart at the height of seats, and the masks of four seats."""
    points = np.dstack([*np.meshgrid(np.arange(96) / 40, np.arange(96) / 40), np.full((96, 96), 0.45)])
    where = np.zeros((96, 96), bool)
    for row in y:
        for column in x:
            where[row : row + 16, column : column + 16] = True
    return points.astype(np.float32), where


def test_a_table_does_not_stand_on_the_seats_around_it():
    around = support_of(*seats((0, 80), (0, 80)))
    assert around.height_m == pytest.approx(0.45)
    assert around.area_m2 == pytest.approx(0.375**2)
    assert height((0.4, 0.4, 0.46), (2.0, 2.0, 0.8), FLOOR, around) == 0.0
    assert height((0.1, 0.1, 0.46), (0.3, 0.3, 0.6), FLOOR, around) == pytest.approx(0.45)


def test_a_few_stray_points_do_not_widen_a_support():
    points, where = seats((0,), (0,))
    points[1, 1] = (30.0, -40.0, 0.45)
    assert height((20.0, -30.0, 0.46), (20.1, -29.9, 0.5), FLOOR, support_of(points, where)) == 0.0
