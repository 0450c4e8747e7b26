from dataclasses import replace

import numpy as np
import pytest

from semmap.nodes.perception_node.input.projection import cloud_of
from semmap.nodes.perception_node.views.fusion import group_segments, same_thing_logits
from semmap.nodes.perception_node.views.segmented_view import SegmentedView, segment_cloud, with_labels
from tests.perception_node.scenes import shot


def truly_cut():
    """Return both views of the scene with ground-truth segments; a label is the number of a body."""
    sights = [segment_cloud(cloud) for cloud in shot().clouds]
    return [
        with_labels(sight, np.where(np.isfinite(sight.cloud.points_camera[..., 2]), owner, 0), frozenset())
        for sight, owner in zip(sights, shot().owners, strict=True)
    ]


def test_segments_of_one_body_are_found_in_both_views():
    sights = truly_cut()
    bodies = [{sights[view].segments[n].label for view, n in group} for group in group_segments(sights)]
    assert all(len(labels) == 1 for labels in bodies)
    assert len(bodies) == len(shot().bodies)


def test_one_view_has_nothing_to_fuse():
    sights = truly_cut()[:1]
    assert group_segments(sights) == [[(0, n)] for n in range(len(sights[0].segments))]


def test_nothing_is_nothing():
    assert group_segments([]) == []


WALL_M, HALF_WIDTH = 2.0, 80


def of_wall(*parts, at_m=0.0, screen=False, carriers=frozenset()):
    """Return the view of a camera at x = `at_m` of a wall with parts from and to these x [m], from 1."""
    intrinsics = np.array([[100.0, 0, HALF_WIDTH], [0, 100.0, 30], [0, 0, 1]])
    depth = np.full((60, 2 * HALF_WIDTH), 1.0 if screen else WALL_M, np.float32)
    pose = np.eye(4)
    pose[0, 3] = at_m
    cloud = cloud_of(depth, None, intrinsics, pose)
    x = at_m + WALL_M * (np.arange(2 * HALF_WIDTH) + 0.5 - HALF_WIDTH) / 100.0
    labels = np.zeros(depth.shape, np.int32)
    for number, (begin, end) in enumerate(parts, 1):
        labels[:, (x > begin) & (x < end)] = number
    nothing, none = np.zeros_like(labels), np.zeros((0, 0), np.float32)
    return with_labels(SegmentedView(cloud, pose, labels, carriers, nothing, (), none), labels, carriers)


@pytest.mark.parametrize(
    ("one", "other", "groups"),
    [
        ([(-0.3, 0.3)], [(-0.3, 0.3)], [[(0, 0), (1, 0)]]),
        ([(-0.3, 0.0), (0.0, 0.3)], [(-0.3, 0.3)], [[(0, 0), (0, 1), (1, 0)]]),
        ([(-0.3, 0.3)], [(-0.3, 0.0), (0.0, 0.3)], [[(0, 0), (1, 0), (1, 1)]]),
        ([(-0.3, 0.0)], [(0.0, 0.3)], [[(0, 0)], [(1, 0)]]),
        ([(-0.3, 0.1)], [(-0.1, 0.5)], [[(0, 0)], [(1, 0)]]),
        ([(-0.3, 0.2)], [(-0.1, 0.3)], [[(0, 0), (1, 0)]]),
        ([(-1.4, -0.5)], [(-1.4, -0.5)], [[(0, 0), (1, 0)]]),
    ],
    ids=["alike", "two in the first", "two in the second", "side by side", "half", "most", "cut"],
)
def test_segments_are_one_thing_if_most_of_one_lies_on_the_other(one, other, groups):
    assert group_segments([of_wall(*one), of_wall(*other, at_m=0.3)]) == groups


def test_a_small_part_of_a_segment_does_not_decide():
    """The second camera sees the last tenth of 2.8 m, on another thing."""
    assert len(group_segments([of_wall((-1.5, 1.26)), of_wall((1.0, 3.0), at_m=2.6)])) == 2
    assert len(group_segments([of_wall((0.7, 1.3)), of_wall((1.0, 3.0), at_m=2.6)])) == 1


def test_a_segment_matches_nothing_behind_a_screen_nor_a_top_what_lies_on_it():
    part = (-0.3, 0.3)
    apart = [[(0, 0)], [(1, 0)]]
    assert group_segments([of_wall(part), of_wall(part, screen=True)]) == apart
    assert group_segments([of_wall(part), of_wall(part, carriers=frozenset({1}))]) == apart
    unknown = of_wall(part)
    for lack in ({"intrinsics": None}, {"map_from_camera": None}):
        view = replace(unknown, cloud=replace(unknown.cloud, **lack))
        assert group_segments([view, view]) == apart


def test_what_cameras_hold_for_one():
    sights = []
    for sight, chance in zip(truly_cut(), (0.2, 0.9), strict=True):
        same = np.zeros((len(shot().bodies),) * 2, np.float32)
        same[0, 1] = same[1, 0] = chance
        sights.append(replace(sight, same=same))
    number = [{segment.label: n for n, segment in enumerate(sight.segments)} for sight in sights]
    groups = [[(view, number[view][label]) for view in (0, 1)] for label in (1, 2, 3)]
    least, most = same_thing_logits(sights, groups)
    assert least[0, 1] == least[1, 0] == pytest.approx(np.log(0.25), abs=1e-3)
    assert most[0, 1] == pytest.approx(np.log(9.0), abs=1e-3)
    assert least[0, 2] == most[0, 2] == 0.0
