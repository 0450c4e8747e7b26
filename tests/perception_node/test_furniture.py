"""What belongs to a table, and what stands beside it."""

from __future__ import annotations

import numpy as np

from nodes.perception_node.furniture import with_what_hangs_below
from nodes.perception_node.segments import Segment


def segment(low, high, *, carrier=False) -> Segment:
    points = np.random.default_rng(0).uniform(low, high, (500, 3)).astype(np.float32)
    return Segment(points, None, 1, np.zeros(3), cut=False, count=500, carrier=carrier)


TOP = segment([-0.5, -0.3, 0.74], [0.5, 0.3, 0.75], carrier=True)


def test_a_leg_belongs_to_the_top_and_a_bin_below_it_does_not():
    leg, bin_ = segment([0.4, 0.2, 0.0], [0.45, 0.25, 0.73]), segment([0, 0, 0], [0.2, 0.2, 0.3])
    assert with_what_hangs_below([[TOP], [leg], [bin_]]) == [[0, 1], [2]]


def test_what_stands_beside_the_top_is_another_thing():
    beside = segment([0.55, -0.1, 0.0], [0.75, 0.1, 0.72])
    assert with_what_hangs_below([[TOP], [beside]]) == [[0], [1]]


def test_a_front_alone_hides_nothing():
    front = segment([-0.5, -0.3, 0.0], [0.5, -0.2999, 0.75], carrier=True)
    beside = segment([-0.1, -0.6, 0.0], [0.1, -0.4, 0.7])
    assert with_what_hangs_below([[front], [beside]]) == [[0], [1]]
