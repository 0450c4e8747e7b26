"""Which neighbours may be joined, and the features of pairs."""

from dataclasses import replace

import numpy as np
import pytest

from semmap.nodes.perception_node.recognition.joining import (
    describe_pair,
    is_worth_joining,
    join_parts,
    near_pairs,
    pair_features,
)
from semmap.nodes.perception_node.recognition.recognition_model import CLUTTER, shipped
from semmap.nodes.perception_node.views.merged_thing import thing_of
from semmap.nodes.perception_node.views.segments import Segment
from semmap.nodes.perception_node.views.supports import Support
from tests.perception_node.scenes import shot
from tests.perception_node.views.test_fusion import truly_cut

CLASSES = shipped().classes


def thing(low, high, *, carrier=False):
    points = np.random.default_rng(0).uniform(low, high, (2000, 3)).astype(np.float32)
    return thing_of(
        [Segment(points, None, 1, np.array([0.0, -1.0, 1.5]), False, 2000, carrier)], [Support(0.7)]
    )


FOOT = thing([0.0, 0.0, 0.7], [0.1, 0.1, 0.72])
SHADE = thing([0.0, 0.0, 0.85], [0.1, 0.1, 1.0])
BESIDE = thing([0.12, 0.0, 0.7], [0.2, 0.1, 0.8])
AWAY = thing([0.4, 0.0, 0.7], [0.5, 0.1, 0.8])


def chances(**likely):
    row = np.zeros(len(CLASSES))
    for name, chance in likely.items():
        row[CLASSES.index(CLUTTER if name == "piece" else name)] = chance
    return row


def test_neighbours_are_beside_or_above_one_another():
    top = thing([-0.5, -0.5, 0.68], [0.5, 0.5, 0.7], carrier=True)
    assert near_pairs([FOOT, SHADE, BESIDE, AWAY, top]) == [(0, 1), (0, 2), (1, 2)]
    assert near_pairs([]) == []


def test_two_masks_of_a_detector_are_two_things():
    masked = [
        replace(one, segments=tuple(replace(segment, masked=True) for segment in one.segments))
        for one in (FOOT, BESIDE)
    ]
    assert near_pairs(masked) == []
    assert near_pairs([masked[0], BESIDE]) == near_pairs([FOOT, masked[1]]) == [(0, 1)]


def test_what_is_known_of_a_pair():
    whole = thing([0.0, 0.0, 0.7], [0.1, 0.1, 1.0])
    held = np.array([[[-1.0, 0.5]], [[2.0, 3.0]]])
    known = describe_pair(FOOT, SHADE, whole, held)
    assert known[3] == pytest.approx(0.13, abs=0.005)  # the gap above
    assert tuple(known[5:7]) == (-1.0, 3.0)
    assert np.exp(known[-1]) == pytest.approx(0.3, abs=0.01)


def test_what_is_recognised_as_different_things_is_not_tried():
    sure, other = chances(Cup=0.97), chances(Bottle=0.97)
    pairs = np.array([[sure, other], [sure, sure], [sure, chances(Bottle=0.4)], [sure, chances(piece=0.7)]])
    assert is_worth_joining(pairs, shipped()).tolist() == [False, True, True, True]


def test_the_order_of_two_does_not_matter():
    a, b, whole = chances(Cup=0.9), chances(Bottle=0.4, piece=0.5), chances(Cup=0.7)
    one_way = describe_pair(FOOT, BESIDE, SHADE, np.zeros((2, 1, 1)))
    other_way = describe_pair(BESIDE, FOOT, SHADE, np.zeros((2, 1, 1)))
    first = pair_features(np.array([[a, b]]), whole[None], one_way[None], shipped())
    again = pair_features(np.array([[b, a]]), whole[None], other_way[None], shipped())
    assert first == pytest.approx(again)


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
