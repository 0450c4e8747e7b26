"""One camera sees one thing where another one sees two."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from nodes.perception_node.disputes import settled
from nodes.perception_node.fusion import fuse
from nodes.perception_node.sights import labelled, see
from tests.perception_node.segmentation.scenes import boxes_on_table, camera_pose

BOXES = (((-0.1, -0.05, 0.0), (0.0, 0.05, 0.12)), ((0.0, -0.05, 0.0), (0.1, 0.05, 0.2)))
EYES = ((-0.6, -0.8, 0.7), (0.6, -0.8, 0.7))


def sights(chance: float):
    """Two views of two boxes side by side; to the first they are one."""
    found = []
    for eye in EYES:
        seen = boxes_on_table(*BOXES, pose=camera_pose(eye=eye), posed=True)
        known = np.isfinite(seen.cloud.points_camera[..., 2])
        found.append((see(seen.cloud), np.where(known, seen.truth, 0)))
    (one, first), (other, second) = found
    same = np.array([[0.0, chance], [chance, 0.0]], np.float32)
    return [
        labelled(one, np.minimum(first, 1), frozenset()),
        replace(labelled(other, second, frozenset()), same=same),
    ], first


def test_two_things_are_two_when_the_camera_that_sees_two_is_sure():
    seen, truth = sights(0.01)
    after = settled(seen)
    assert after[0].labels.max() == 2
    where = truth > 0
    number = {int(after[0].labels[truth == n][0]): n for n in (1, 2)}
    assert len(number) == 2
    right = np.vectorize(lambda label: number.get(int(label), 0))(after[0].labels[where]) == truth[where]
    assert right.mean() > 0.95
    assert len(fuse(after)) == 2


@pytest.mark.parametrize("chance", [0.3, 0.0])
def test_pieces_of_which_nobody_is_sure_are_one_thing(chance):
    seen, _ = sights(chance)
    after = settled(seen)
    assert after[0].labels is seen[0].labels
    assert len(fuse(after)) == 1


def test_one_camera_disputes_nothing():
    seen, _ = sights(0.01)
    assert settled(seen[:1]) == seen[:1]
    assert settled([]) == []
