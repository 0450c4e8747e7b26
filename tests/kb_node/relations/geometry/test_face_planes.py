"""Heights of a vertical line in a part equal those of points of the part on that line."""

import math

import pytest

from semmap.nodes.kb_node.relations.geometry.convex import make_convex

_WEDGE = tuple((x, y, z) for y in (-0.5, 0.5) for x, z in ((-1.0, 0.0), (1.0, 0.0), (1.0, 0.5)))
R = math.sqrt(0.5)


@pytest.mark.parametrize(
    ("part", "at", "heights"),
    [
        pytest.param(make_convex((0, 0, 1), (), (), _WEDGE), (-0.6, 0.1), (1.0, 1.1), id="wedge, low end"),
        pytest.param(make_convex((0, 0, 1), (), (), _WEDGE), (0.6, -0.4), (1.0, 1.4), id="wedge, high end"),
        pytest.param(
            make_convex((2, 0, 1), ((R, 0, R),), ((0, 0.1, 0), (-0.1 * R, 0, 0.1 * R))),
            (2.3, 0.0),
            (1.3 - 0.1 / R, 1.3 + 0.1 / R),
            id="tilted cylinder",
        ),
        pytest.param(
            make_convex((0, 0, 0), ((R, 0, R),), ((0.1, 0, 0), (0, 0.1, 0), (0, 0, 0.1))),
            (-0.3, 0.0),
            (-0.3 - 0.1 / R, -0.3 + 0.1 / R),
            id="tilted capsule",
        ),
        pytest.param(
            make_convex((0, 0, 0), (), ((0.1, 0, 0), (0, 0.1, 0), (0, 0, 0.1))), (0, 0), (-0.1, 0.1)
        ),
        pytest.param(make_convex((0, 0, 0), ((0, 0, 1),), ((0.1, 0, 0), (0, 0.1, 0))), (0.05, 0), (-1, 1)),
    ],
)
def test_heights_of_a_line_in_a_part(part, at, heights):
    assert part.find_heights(at) == pytest.approx(heights, abs=2e-3)
    assert len(part.round) == 3 or part.lowest_top <= part.find_heights(at)[1] + 1e-9
