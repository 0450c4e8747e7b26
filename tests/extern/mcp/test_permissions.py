import pytest

from semmap.nodes.extern.mcp.permissions import find_outside
from semmap.schemas.plans import PlannedPlace


def place(name, x, y, width, depth):
    corners = ((x, y), (x + width, y), (x + width, y + depth), (x, y + depth))
    return PlannedPlace(name=name, label=name, class_="Kitchen", rings=(corners,), floor=0.0, height=2.5)


KITCHEN, HALL = place("kitchen1", 0.0, 0.0, 4.0, 3.0), place("hall1", 4.0, 0.0, 2.0, 3.0)


@pytest.mark.parametrize(
    ("path", "places", "is_outside"),
    [
        (((1.0, 1.0), (3.0, 2.0)), [KITCHEN], False),
        (((1.0, 1.0), (5.0, 2.0)), [KITCHEN], True),
        (((1.0, 1.0), (5.0, 2.0)), [KITCHEN, HALL], False),
        (((1.0, 1.0), (3.0, 4.0), (1.0, 2.0)), [KITCHEN], True),
        (((3.9, 2.9), (3.9, 3.5)), [KITCHEN], True),
        (((3.5, 1.0),), [HALL], True),
        (((1.0, 1.0),), [], True),
    ],
)
def test_a_path_within_places(path, places, is_outside):
    assert (find_outside(path, places) is not None) == is_outside


def test_the_first_point_outside_is_returned():
    x, y = find_outside(((3.0, 1.0), (5.0, 1.0)), [KITCHEN])
    assert 4.0 <= x <= 4.2
    assert y == pytest.approx(1.0)
