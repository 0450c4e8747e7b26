"""Whether a box, a point or a place is in a place of 4 by 4 by 3 m."""

import math

import pytest

from semmap.nodes.kb_node.relations.measuring.measures import Measure
from semmap.nodes.kb_node.relations.measuring.places import within
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from tests.kb_node.relations.entities import thing

LIMITS = Thresholds()
CUBE = (1.0, 1.0, 1.0)


def solid(at, size=None, **options):
    return Space([thing("a1", at, "unheard of", size=size, **options)]).solids["a1"]


ROOM = solid((0.0, 0.0, 0.0), (4.0, 4.0, 3.0), place=True)


@pytest.mark.parametrize(
    ("inner", "share"),
    [
        (solid((0.0, 0.0, 0.0), CUBE), 1.0),
        (solid((0.0, 0.0, 0.0), CUBE, yaw=math.pi / 4), 1.0),
        (solid((2.0, 0.0, 0.0), CUBE), 0.5),
        (solid((0.0, -2.1, 0.0), CUBE), 0.4),
        (solid((2.6, 0.0, 0.0), CUBE), 0.0),
        (solid((0.0, 0.0, 2.5), CUBE), 1.0),  # its centre counts
        (solid((0.0, 0.0, 2.6), CUBE), 0.0),
        (solid((0.0, 0.0, -0.54), CUBE), 1.0),
        (solid((0.0, 0.0, -0.6), CUBE), 0.0),
        (solid((1.9, 0.0, 0.0)), 1.0),
        (solid((2.1, 0.0, 0.0)), 0.0),
        (solid((0.0, 0.0, 3.04)), 1.0),
        (solid((0.0, 0.0, 3.06)), 0.0),
    ],
)
def test_the_share_within_a_place(inner, share):
    made = Measure(share >= 0.5, share=share, limit=0.5)
    assert within(inner, ROOM, LIMITS) == pytest.approx(tuple(made))


def test_only_a_place_with_an_extent_contains_and_places_only_on_request():
    cube, corner = solid((1.0, 1.0, 0.0), CUBE), solid((1.0, 1.0, 0.0), CUBE, place=True)
    assert within(ROOM, cube, LIMITS, also_places=True) is None
    assert within(cube, solid((1.0, 1.0, 0.0), place=True), LIMITS) is None
    assert within(corner, ROOM, LIMITS) is None
    assert within(corner, ROOM, LIMITS, also_places=True).share == 1.0
    assert within(ROOM, corner, LIMITS, also_places=True).holds is False
