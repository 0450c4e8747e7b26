"""One camera sees one thing where another sees two."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from semmap.nodes.perception_node.views.fusion import group_segments
from semmap.nodes.perception_node.views.segmented_view import segment_cloud, with_labels
from semmap.nodes.perception_node.views.split_segments import resolve_splits
from tests.perception_node.segmentation.scenes import boxes_on_table, camera_pose

BOXES = (((-0.1, -0.05, 0.0), (0.0, 0.05, 0.12)), ((0.0, -0.05, 0.0), (0.1, 0.05, 0.2)))
EYES = ((-0.6, -0.8, 0.7), (0.6, -0.8, 0.7))


def sights():
    """Return two views of two adjacent boxes, merged in the first, and the ground truth of the first."""
    found = []
    for eye in EYES:
        seen = boxes_on_table(*BOXES, pose=camera_pose(eye=eye), posed=True)
        known = np.isfinite(seen.cloud.points_camera[..., 2])
        found.append((segment_cloud(seen.cloud), np.where(known, seen.truth, 0)))
    (one, first), (other, second) = found
    bare = [replace(sight, same=np.zeros((0, 0), np.float32)) for sight in (one, other)]
    return [
        with_labels(bare[0], np.minimum(first, 1), frozenset()),
        with_labels(bare[1], second, frozenset()),
    ], first


def test_what_another_camera_sees_as_two_is_cut_in_two():
    seen, truth = sights()
    after = resolve_splits(seen)
    assert after[0].labels.max() == 2
    where = truth > 0
    number = {int(after[0].labels[truth == n][0]): n for n in (1, 2)}
    assert len(number) == 2
    right = np.vectorize(lambda label: number.get(int(label), 0))(after[0].labels[where]) == truth[where]
    assert right.mean() > 0.95
    assert len(group_segments(after)) == 2


def test_parts_of_one_segment_were_held_for_one():
    seen, _ = sights()
    assert resolve_splits(seen)[0].same[0, 1] == 1.0


def test_what_was_known_of_a_segment_holds_for_its_parts():
    seen, _ = sights()
    third = seen[0].labels.copy()
    third[:4, :4] = 2  # a thing apart, of which the camera knows how likely it is one with the first
    same = np.array([[0.0, 0.3], [0.3, 0.0]], np.float32)
    after = resolve_splits([replace(with_labels(seen[0], third, frozenset()), same=same), seen[1]])[0]
    assert after.labels.max() == 3
    assert after.same[0, 1] == after.same[2, 1] == np.float32(0.3)
    assert after.same[0, 2] == 1.0


def test_one_camera_disputes_nothing():
    seen, _ = sights()
    assert resolve_splits(seen[:1]) == seen[:1]
    assert resolve_splits([]) == []
