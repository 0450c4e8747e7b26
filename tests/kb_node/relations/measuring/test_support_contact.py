"""How a box rests on another one."""

import pytest

from semmap.nodes.kb_node.relations.measuring.measures import Measure, is_rectangle_within, overlap
from semmap.nodes.kb_node.relations.measuring.space import Space
from semmap.nodes.kb_node.relations.measuring.support_contact import is_balanced, is_in_open_hollow, on, over
from semmap.nodes.kb_node.relations.measuring.thresholds import Thresholds
from tests.kb_node.relations.entities import thing

LIMITS = Thresholds()


def solid(at, size):
    return Space([thing("a1", at, "", size=size)]).solids["a1"]


def approximately(made):
    return made and pytest.approx(tuple(made), abs=1e-6)


@pytest.mark.parametrize(
    ("x", "z", "thick", "found"),
    [
        (0.0, 1.0, 1.0, (True, 0.0, 1.0, 1.0, 0.05)),
        (0.0, 1.04, 1.0, (True, 0.04, 1.0, 1.0, 0.05)),
        (0.0, 0.96, 1.0, (True, -0.04, 1.0, 1.0, 0.05)),
        (0.5, 1.0, 1.0, (True, 0.0, 0.5, 1.0, 0.05)),
        (-0.59, 1.0, 1.0, (True, 0.0, 0.05, 1.0, 0.05)),
        (0.61, 1.0, 1.0, None),
        (0.0, 1.06, 1.0, None),
        (0.0, 0.94, 1.0, None),
        (0.0, 0.0, 0.02, (True, -0.02, 1.0, 0.02, 0.0015)),  # it rests on the same floor
        (0.0, -0.01, 0.02, None),  # it rests lower than what would be below it
    ],
)
def test_a_box_on_another_one(x, z, thick, found):
    lower = solid((0.0, 0.0, 0.0), (1.0, 1.0, thick))
    made = on(solid((x, 0.1, z), (0.2, 0.2, 0.2)), lower, LIMITS)
    assert made == (found and approximately(Measure(*found)))
    assert on(lower, lower, LIMITS) is None


@pytest.mark.parametrize(
    ("x", "z", "found"),
    [
        (0.0, 1.5, (False, 0.5, 1.0, 1.0, 0.25)),
        (0.5, 1.5, (False, 0.5, 0.5, 1.0, 0.25)),
        (-0.45, 0.2, (False, -0.8, 0.75, 1.0, 0.25)),
        (0.61, 1.5, None),
    ],
)
def test_a_box_over_another_one(x, z, found):
    lower = solid((0.0, 0.0, 0.0), (1.0, 1.0, 1.0))
    assert over(solid((x, 0.0, z), (0.2, 0.2, 0.2)), lower, LIMITS) == (
        found and approximately(Measure(*found))
    )
    assert over(lower, lower, LIMITS) is None


@pytest.mark.parametrize(
    ("posts", "is_so"),
    [
        ([(0.0, 0.0)], True),
        ([(-0.4, 0.0), (0.4, 0.0)], True),
        ([(0.4, -0.4), (0.4, 0.4)], False),
        ([(0.4, -0.4), (0.4, 0.4), (-0.4, 0.0)], True),
        ([], False),
    ],
)
def test_a_top_is_balanced_if_its_centre_is_between_its_posts(posts, is_so):
    top = solid((0.0, 0.0, 1.0), (1.0, 1.0, 0.1))
    below = [solid((x, y, 0.0), (0.2, 0.2, 1.0)) for x, y in posts]
    assert is_balanced(top, below, 1.0) == is_so
    assert not is_balanced(top, below, 1.1), "they end below this height"


@pytest.mark.parametrize(
    ("x", "size", "above_m", "is_so"),
    [
        (0.0, (0.08, 0.08, 0.1), 0.0, True),
        (0.0, (0.08, 0.08, 0.1), 0.1, False),  # it rests above the floor
        (0.5, (0.08, 0.08, 0.1), 0.0, False),  # most of it is over the rim
        (0.0, (1.0, 1.0, 1.0), 0.0, False),  # the larger one
    ],
)
def test_an_object_in_a_tray_stands_on_its_floor(x, size, above_m, is_so):
    tray = Space([thing("tray1", (0.0, 0.0, 0.0))]).solids["tray1"]
    (hollow,) = tray.form.shape.interiors
    made = Measure(True, height_m=hollow.low[2] + above_m)
    cup = solid((x * tray.size[0], 0.0, made.height_m), size)
    assert is_in_open_hollow(tray, cup, made) == is_so
    assert not is_in_open_hollow(solid((0.0, 0.0, 0.0), tray.size), cup, made), "it has no hollow"


@pytest.mark.parametrize(
    ("other", "margin_m", "meets"),
    [
        ((1.0, 0.0, 2.0, 1.0), 0.0, True),
        ((1.1, 0.0, 2.0, 1.0), 0.0, False),
        ((1.1, 0.0, 2.0, 1.0), 0.2, True),
        ((-2.0, 0.0, -0.1, 1.0), 0.0, False),
        ((-2.0, 0.0, -0.1, 1.0), 0.2, True),
        ((0.0, 1.1, 1.0, 2.0), 0.0, False),
        ((0.0, 1.1, 1.0, 2.0), 0.2, True),
        ((0.0, -2.0, 1.0, -0.1), 0.0, False),
        ((0.0, -2.0, 1.0, -0.1), 0.2, True),
    ],
)
def test_rectangles_meet_within_a_margin(other, margin_m, meets):
    one = (0.0, 0.0, 1.0, 1.0)
    assert overlap(one, other, margin_m) == overlap(other, one, margin_m) == meets
    assert margin_m or overlap(one, other) == meets
    assert is_rectangle_within(one, one)
    assert not is_rectangle_within(other, one)
