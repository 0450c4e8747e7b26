from dataclasses import replace

import numpy as np
import pytest

from semmap.nodes.perception_node.views.fusion import group_segments, same_thing_logits
from semmap.nodes.perception_node.views.segmented_view import segment_cloud, with_labels
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
