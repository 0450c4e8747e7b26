"""Parts as segments, ellipsoids and hulls."""

import math
from dataclasses import replace

import numpy as np
import pytest

from semmap.nodes.sim_node.models.convex_parts import convex_part
from semmap.nodes.sim_node.models.parts import about, ball, box, mesh, pill, rod

RED = (1.0, 0.0, 0.0)
QUARTER = about("z", math.pi / 2)


def rows(*vectors):
    return pytest.approx(np.array(vectors, dtype=float), abs=1e-9)


def test_a_box_is_three_segments_that_turn_with_it():
    part = convex_part(box((0.2, 0.4, 0.6), (1, 2, 3), RED, QUARTER))
    assert part.centre == (1, 2, 3)
    assert np.array(part.straight) == rows((0, 0.1, 0), (-0.2, 0, 0), (0, 0, 0.3))
    assert (part.round, part.points) == ((), ())


def test_a_ball_is_an_ellipsoid():
    part = convex_part(ball((0.2, 0.4, 0.6), (1, 2, 3), RED, QUARTER))
    assert np.array(part.round) == rows((0, 0.1, 0), (-0.2, 0, 0), (0, 0, 0.3))
    assert part.straight == ()


def test_a_rod_is_a_disc_and_a_segment_and_a_pill_a_ball_and_a_segment():
    lying = about("y", math.pi / 2)
    part = convex_part(rod(0.1, 0.6, (1, 2, 3), RED, lying))
    assert np.array(part.straight) == rows((0.3, 0, 0))
    assert np.array(part.round) == rows((0, 0, -0.1), (0, 0.1, 0))
    part = convex_part(pill(0.1, 0.6, (1, 2, 3), RED, lying))
    assert np.array(part.straight) == rows((0.2, 0, 0))
    assert np.array(part.round) == rows((0, 0, -0.1), (0, 0.1, 0), (0.1, 0, 0))


def test_a_mesh_is_the_corners_of_its_hull():
    corners = np.array([(0, 0, 0), (2, 0, 0), (0, 2, 0), (0, 0, 2), (0.2, 0.2, 0.2)], dtype=float)
    faces = np.array([(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)], dtype=np.int32)
    part = convex_part(replace(mesh(corners, faces, RED), turn=QUARTER))
    assert part.centre == (1.0, 1.0, 1.0)
    expected = sorted([(1.0, -1.0, -1.0), (1.0, 1.0, -1.0), (-1.0, -1.0, -1.0), (1.0, -1.0, 1.0)])
    assert np.array(sorted(tuple(np.round(p, 9) + 0.0) for p in part.points)) == rows(*expected)
