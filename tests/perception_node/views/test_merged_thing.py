import numpy as np
import pytest

from semmap.nodes.perception_node.views.merged_thing import thing_of
from semmap.nodes.perception_node.views.segments import Segment
from semmap.nodes.perception_node.views.supports import Support

RNG = np.random.default_rng(0)


def segment(points, **more):
    points = np.asarray(points, np.float32)
    settings = {
        "colors": None,
        "label": 1,
        "eye": np.array([1.0, 0.0, 1.0]),
        "cut": False,
        "count": len(points),
    }
    return Segment(points, **(settings | more))


def block(low, high, count=2000):
    return RNG.uniform(low, high, (count, 3))


def test_it_stands_on_the_highest_support_below():
    thing = thing_of(
        [segment(block([0, 0, 0.71], [0.1, 0.1, 0.9]))], [Support(0.0), Support(0.7), Support(1.2)]
    )
    assert thing.box.low[2] == pytest.approx(0.7)
    assert thing.box.size_m == pytest.approx([0.1, 0.1, 0.2], abs=0.01)
    assert thing.lifted_m == pytest.approx(0.01, abs=0.005)


def test_a_table_top_is_no_support_of_its_own():
    top = segment(block([0, 0, 0.69], [1.0, 0.6, 0.7], 4000), carrier=True)
    assert thing_of([top], [Support(0.0), Support(0.7)]).box.low[2] == pytest.approx(0.0)


def test_what_is_far_behind_the_outline_is_no_part():
    stray = block([0.5, 0.5, 0.3], [0.52, 0.52, 0.32], 20)
    thing = thing_of([segment([*block([0, 0, 0], [0.1, 0.1, 0.1]), *stray])], [Support(0.0)])
    assert thing.box.size_m == pytest.approx([0.1, 0.1, 0.1], abs=0.01)


def test_near_and_far_views_weigh_the_same():
    left, right = block([0, 0, 0], [0.1, 0.1, 0.004], 20000), block([0.1, 0, 0], [0.2, 0.1, 0.004], 6000)
    thing = thing_of([segment(left), segment(right, eye=np.array([-1.0, 0.0, 1.0]))], [Support(0.0)])
    assert thing.cells[:, 0].mean() == pytest.approx(0.1, abs=0.01)
    assert len(thing.eyes) == 2
    assert thing.count == 26000


@pytest.mark.parametrize("points", [[[1, 2, 3]], [[1, 2, 3]] * 50, block([-40, -40, -40], [40, 40, 40], 60)])
def test_strange_points_make_a_thing_too(points):
    assert (thing_of([segment(points)], [Support(0.0)]).box.size_m > 0).all()


def test_colours_are_shares_of_full_light():
    colors = np.full((2000, 3), 255, np.uint8)
    thing = thing_of([segment(block([0, 0, 0], [0.1, 0.1, 0.1]), colors=colors)], [Support(0.0)])
    assert thing.colors == pytest.approx(1.0)


def test_a_thing_is_what_one_of_its_segments_is():
    points = block([0, 0, 0], [0.1, 0.1, 0.1])
    thing = thing_of([segment(points), segment(points)], [Support(0.0)])
    assert (thing.carrier, thing.masked, thing.whole, thing.count) == (False, False, True, 4000)
    for change, found in (
        ({"carrier": True}, (True, False, True)),
        ({"masked": True}, (False, True, True)),
        ({"cut": True}, (False, False, False)),
    ):
        thing = thing_of([segment(points), segment(points, **change)], [Support(0.0)])
        assert (thing.carrier, thing.masked, thing.whole) == found
