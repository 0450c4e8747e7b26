"""Outliers are left out of a view of the whole."""

import numpy as np
import pytest

from semmap.nodes.geometry.outliers import find_near


@pytest.mark.parametrize(
    ("points", "near"),
    [
        ([], []),
        ([(900.0, 0.0, 0.0)], [True]),
        ([(0.0, 0.0, 0.0), (900.0, 0.0, 0.0)], [True, True]),
        ([(0.1 * i, 0.0, 0.0) for i in range(9)] + [(50.0, 0.0, 0.0)], [True] * 9 + [False]),
        ([(0.1 * i, 0.0, 0.0) for i in range(9)] + [(3.0, 0.0, 0.0)], [True] * 10),
        ([(10.0 * i, 5.0 * (i % 2), 0.0) for i in range(20)], [True] * 20),
    ],
)
def test_far_points_are_outliers_unless_there_are_many(points, near):
    assert find_near(np.array(points, dtype=float).reshape(-1, 3)).tolist() == near
