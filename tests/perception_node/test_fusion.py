import numpy as np

from nodes.perception_node.fusion import fuse
from nodes.perception_node.sights import labelled, see
from tests.perception_node.scenes import shot


def truly_cut():
    """Both views of the scene, cut up as the truth has it; a label is the number of a body."""
    sights = [see(cloud) for cloud in shot().clouds]
    return [
        labelled(sight, np.where(np.isfinite(sight.cloud.points_camera[..., 2]), owner, 0), frozenset())
        for sight, owner in zip(sights, shot().owners, strict=True)
    ]


def test_segments_of_one_body_are_found_in_both_views():
    sights = truly_cut()
    bodies = [{sights[view].segments[n].label for view, n in group} for group in fuse(sights)]
    assert all(len(labels) == 1 for labels in bodies)
    assert len(bodies) == len(shot().bodies)


def test_one_view_has_nothing_to_fuse():
    sights = truly_cut()[:1]
    assert fuse(sights) == [[(0, n)] for n in range(len(sights[0].segments))]


def test_nothing_is_nothing():
    assert fuse([]) == []
