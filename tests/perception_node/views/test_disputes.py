"""One camera sees one thing where another one sees two."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from semmap.nodes.perception_node.views.disputes import settled
from semmap.nodes.perception_node.views.fusion import fuse
from semmap.nodes.perception_node.views.segmented_view import labelled, see
from tests.perception_node.segmentation.scenes import boxes_on_table, camera_pose

BOXES = (((-0.1, -0.05, 0.0), (0.0, 0.05, 0.12)), ((0.0, -0.05, 0.0), (0.1, 0.05, 0.2)))
EYES = ((-0.6, -0.8, 0.7), (0.6, -0.8, 0.7))


def sights():
    """Two views of two boxes side by side; to the first they are one. And the truth about the first."""
    found = []
    for eye in EYES:
        seen = boxes_on_table(*BOXES, pose=camera_pose(eye=eye), posed=True)
        known = np.isfinite(seen.cloud.points_camera[..., 2])
        found.append((see(seen.cloud), np.where(known, seen.truth, 0)))
    (one, first), (other, second) = found
    bare = [replace(sight, same=np.zeros((0, 0), np.float32)) for sight in (one, other)]
    return [
        labelled(bare[0], np.minimum(first, 1), frozenset()),
        labelled(bare[1], second, frozenset()),
    ], first


def test_what_another_camera_sees_as_two_is_cut_in_two():
    seen, truth = sights()
    after = settled(seen)
    assert after[0].labels.max() == 2
    where = truth > 0
    number = {int(after[0].labels[truth == n][0]): n for n in (1, 2)}
    assert len(number) == 2
    right = np.vectorize(lambda label: number.get(int(label), 0))(after[0].labels[where]) == truth[where]
    assert right.mean() > 0.95
    assert len(fuse(after)) == 2


def test_parts_of_one_segment_were_held_for_one():
    seen, _ = sights()
    assert settled(seen)[0].same[0, 1] == 1.0


def test_what_was_known_of_a_segment_holds_for_its_parts():
    seen, _ = sights()
    third = seen[0].labels.copy()
    third[:4, :4] = 2  # a thing apart, of which the camera knows how likely it is one with the first
    same = np.array([[0.0, 0.3], [0.3, 0.0]], np.float32)
    after = settled([replace(labelled(seen[0], third, frozenset()), same=same), seen[1]])[0]
    assert after.labels.max() == 3
    assert after.same[0, 1] == after.same[2, 1] == np.float32(0.3)
    assert after.same[0, 2] == 1.0


def test_one_camera_disputes_nothing():
    seen, _ = sights()
    assert settled(seen[:1]) == seen[:1]
    assert settled([]) == []
