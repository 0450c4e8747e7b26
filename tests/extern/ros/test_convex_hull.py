"""The hull of points, against that of SciPy."""

from collections import Counter

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from semmap.nodes.extern.ros.convex_hull import hull_triangles


def volume(points, triangles):
    a, b, c = (points[triangles[:, k]] for k in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum()) / 6.0


def is_closed(triangles):
    """Return whether each edge has one triangle on either side, both turning the same way."""
    edges = Counter((int(t[k]), int(t[(k + 1) % 3])) for t in triangles for k in range(3))
    return all(number == 1 and edges[last, first] == 1 for (first, last), number in edges.items())


@pytest.mark.parametrize("seed", range(20))
def test_it_has_the_volume_of_another_program(seed):
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(int(rng.integers(8, 60)), 3)).round(int(rng.integers(0, 4)))  # also in a grid
    corners, triangles = hull_triangles(points)
    assert is_closed(triangles)
    assert volume(corners, triangles) == pytest.approx(ConvexHull(points).volume, rel=1e-4)


@pytest.mark.parametrize("axes", [2, 1, 0])
def test_flat_sets_of_points_are_closed_too(axes):
    points = np.zeros((9, 3))
    points[:, :axes] = np.random.default_rng(axes).normal(size=(9, axes))
    corners, triangles = hull_triangles(points)
    assert is_closed(triangles)
    assert 0.0 <= volume(corners, triangles) < 1e-4
    assert np.ptp(corners, axis=0) == pytest.approx(np.ptp(points, axis=0), abs=1e-4)
