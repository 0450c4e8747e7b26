from dataclasses import replace

import numpy as np
import pytest

from semmap.nodes.perception_node.recognition.part_joining import join_parts
from semmap.nodes.perception_node.recognition.recognition_model import shipped
from semmap.nodes.perception_node.views.merged_thing import thing_of
from semmap.nodes.perception_node.views.supports import Support
from tests.perception_node.scenes import shot
from tests.perception_node.views.test_fusion import truly_cut

SUPPORTS = [Support(0.0), Support(0.7)]
UNASKED = np.zeros((2, 2, 2))


def join(a, b):
    return thing_of((*a.segments, *b.segments), SUPPORTS)


def body(name):
    """Return the segments of one body in both views."""
    number = [b.name for b in shot().bodies].index(name) + 1
    return [s for sight in truly_cut() for s in sight.segments if s.label == number]


def test_what_is_recognised_stays_apart():
    things = [thing_of(body("bottle"), SUPPORTS), thing_of(body("cereals"), SUPPORTS)]
    parts, chances, members = join_parts(things, UNASKED, shipped(), join)
    assert (len(parts), members) == (2, [[0], [1]])
    assert [shipped().classes[k] for k in chances.argmax(axis=1)] == ["Bottle", "Cereals"]


@pytest.mark.parametrize("from_m", [0.17, 0.18, 0.20, 0.22])
def test_a_neck_finds_its_bottle(from_m):
    halves = [
        thing_of([_part(s, (s.points[:, 2] > 0.7 + from_m) == upper) for s in body("bottle")], SUPPORTS)
        for upper in (False, True)
    ]
    parts, chances, members = join_parts(halves, UNASKED, shipped(), join)
    assert members == [[0, 1]]
    assert shipped().classes[int(chances[0].argmax())] == "Bottle"
    assert parts[0].box.size_m[2] > 0.25


def _part(segment, rows):
    return replace(segment, points=segment.points[rows], colors=segment.colors[rows])


def test_nothing_is_nothing():
    assert join_parts([], np.zeros((2, 0, 0)), shipped(), join)[2] == []
