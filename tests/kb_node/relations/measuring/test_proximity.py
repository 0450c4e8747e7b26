"""Distances of two boxes: contact, nearness, and one against the side of another."""

import math

import pytest

from semmap.nodes.kb_node.relations.measuring.measures import Measure
from semmap.nodes.kb_node.relations.measuring.proximity import against, gap, gap_from_above, near, touches
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from tests.kb_node.relations.entities import thing

LIMITS = Thresholds()
CUBE = (1.0, 1.0, 1.0)


def solid(at, size=CUBE, **options):
    return Space([thing("a1", at, "", size=size, **options)]).solids["a1"]


def approximately(made):
    return made and pytest.approx(tuple(made), abs=1e-6)


@pytest.mark.parametrize(
    ("at", "options", "apart", "sideways"),
    [
        ((0.0, 0.0, 0.5), {}, 0.0, 0.0),
        ((1.5, 0.0, 0.5), {}, 0.5, 0.5),
        ((0.0, 0.0, 1.25), {}, 0.25, 0.0),
        ((0.0, 0.0, -3.0), {}, 2.0, 0.0),
        ((0.0, 4.0, 5.0), {}, 5.0, 3.0),
        ((1.5, 0.0, 0.0), {"yaw": math.pi / 4}, 1.0 - math.sqrt(0.5), 1.0 - math.sqrt(0.5)),
        ((-4.0, 0.0, 5.0), {"place": True}, 5.0, 3.0),
    ],
)
def test_the_distance_of_two_boxes(at, options, apart, sideways):
    one, other = solid((0.0, 0.0, 0.0)), solid(at, **options)
    assert gap(one, other) == gap(other, one) == pytest.approx(apart)
    assert gap_from_above(one, other) == gap_from_above(other, one) == pytest.approx(sideways)


@pytest.mark.parametrize(
    ("at", "apart"),
    [
        ((1.001, 0.0, 0.0), 0.001),
        ((0.0, -1.001, 0.5), 0.001),
        ((0.2, 0.0, 1.001), 0.001),
        ((0.0, 0.2, -1.001), 0.001),
        ((0.0, 0.0, 0.99), -0.01),
        ((1.002, 0.0, 0.0), None),
        ((0.0, 1.002, 0.0), None),
        ((0.0, 0.0, 1.002), None),
        ((0.0, 0.0, -1.002), None),
    ],
)
def test_boxes_touch_up_to_the_contact_limit(at, apart):
    expected = None if apart is None else approximately(Measure(True, apart, limit=LIMITS.contact_m))
    for one, other in ((solid((0.0, 0.0, 0.0)), solid(at)), (solid(at), solid((0.0, 0.0, 0.0)))):
        assert touches(one, other, LIMITS) == expected
    assert touches(one, one, LIMITS) is None


@pytest.mark.parametrize(
    ("y", "z", "found"),
    [
        (0.56, 1.0, (True, 0.01, 1.0)),
        (0.56, 2.5, (True, 0.01, 0.5)),
        (0.56, 2.75, (False, 0.01, 0.25)),
        (0.65, 1.0, (False, 0.1, 1.0)),
        (0.8, 1.0, None),  # too far to be compared
        (0.56, 3.0, None),  # above it
        (0.56, 0.05, None),  # at its base
        (0.56, 0.06, (True, 0.01, 1.0)),
    ],
)
def test_a_picture_is_against_a_wall_alongside_half_of_its_height(y, z, found):
    wall, picture = solid((0.0, 0.0, 0.0), (3.0, 1.0, 3.0)), solid((0.0, y, z), (1.0, 0.1, 1.0))
    made = against(picture, wall, LIMITS)
    assert made == (found and approximately(Measure(*found, limit=LIMITS.attached_m)))
    place = solid((0.0, 0.0, 0.0), (3.0, 1.0, 3.0), place=True)
    assert against(picture, place, LIMITS) is against(place, picture, LIMITS) is None
    assert against(picture, picture, LIMITS) is None


@pytest.mark.parametrize(
    ("size", "x", "holds", "apart", "limit"),
    [
        (0.4, 0.59, True, 0.29, 0.3),
        (0.4, 0.61, False, 0.31, 0.3),
        (6.0, 4.0, True, 0.9, 1.0),  # never more than a metre
        (6.0, 4.2, False, 1.1, 1.0),
    ],
)
def test_objects_are_near_within_their_mean_length(size, x, holds, apart, limit):
    one, other = solid((0.0, 0.0, 0.0), (0.2, 0.1, 0.1)), solid((x, 0.0, 0.0), (size, 0.1, 0.1))
    assert near(one, other, LIMITS) == approximately(Measure(holds, apart, limit=limit))
    assert near(one, one, LIMITS) is near(one, solid((x, 0.0, 0.0), place=True), LIMITS) is None
