"""What belongs to a table, and what stands beside it."""

from __future__ import annotations

import numpy as np

from nodes.perception_node.segmentation import Plane, Segmentation
from nodes.perception_node.views.furniture_planes import with_furniture, with_what_hangs_below
from nodes.perception_node.views.segments import Segment


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


def test_what_stands_on_a_top_ends_there():
    """On the left a thing that was cut out together with the rim below it, on the right the top itself."""
    labels = np.zeros((40, 40), np.int32)
    labels[:, :20] = 1
    across = np.linspace(-0.3, 0.3, 40, dtype=np.float32)
    points = np.stack(np.broadcast_arrays(np.abs(across), across[:, None], np.float32(0.8)), axis=-1).copy()
    points[:, :20, :2] *= 0.8
    points[:, :20, 2] = np.linspace(1.06, 0.56, 40)[:, None]
    top = Plane(np.array([0.0, 0.0, 1.0]), 0.8, "support", 800, (0.6, 0.3))
    seen = Segmentation(labels, (top,), 1 - labels, np.zeros((1, 1), np.float32))
    cut, furniture = with_furniture(seen, points[::4, ::4])
    assert furniture == {2}
    assert (cut[points[..., 2] < 0.73] == 2).all()
    assert (cut[:, :20][points[:, :20, 2] > 0.83] == 1).all()
