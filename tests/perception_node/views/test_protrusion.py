"""Things stand out from the surface around them, by height or colour; noise does not."""

from dataclasses import replace

import numpy as np
import pytest

from semmap.nodes.perception_node.pipeline import observe_clouds, parts_in
from semmap.nodes.perception_node.recognition.recognition_model import shipped
from semmap.nodes.perception_node.views.protrusion import doubts
from semmap.nodes.perception_node.views.segmented_view import segment_cloud, with_labels
from tests.perception_node.segmentation.scenes import boxes_on_table, camera_pose

BOX = ((-0.05, -0.05, 0.0), (0.05, 0.05, 0.1))
GREY, RED = (120, 120, 120), (200, 40, 40)


@pytest.fixture(scope="module")
def view():
    """A view of a grey box on a grey table; the box is segment 1."""
    seen = boxes_on_table(BOX, pose=camera_pose(eye=(0.0, -0.8, 1.35), target=(0.0, 0.0, 0.75)), posed=True)
    colors = np.random.default_rng(0).normal(GREY, 8, (*seen.truth.shape, 3)).astype(np.uint8)
    return with_labels(segment_cloud(replace(seen.cloud, colors=colors)), seen.truth, frozenset())


def doubts_of(sight, labels=None):
    labels = sight.labels if labels is None else labels
    sight = with_labels(sight, labels, frozenset())
    return doubts([sight], [labels], parts_in([sight]).things)


def patch_of(sight):
    """Return labels (H, W) of a patch of the bare table."""
    labels = np.zeros_like(sight.labels)
    labels[300:360, 100:180] = 1
    return labels


def test_a_box_of_the_colour_of_its_table_is_a_thing(view):
    assert view.labels.max() == 1
    assert doubts_of(view) == [""]


def test_a_patch_of_the_table_is_no_thing_unless_it_has_another_colour(view):
    (doubt,) = doubts_of(view, patch_of(view))
    assert "mm above a surface with" in doubt
    colors = view.cloud.colors.copy()
    colors[patch_of(view) > 0] = RED
    assert doubts_of(replace(view, cloud=replace(view.cloud, colors=colors)), patch_of(view)) == [""]


def test_a_thing_is_doubted_also_after_one_that_is_too_small_for_it(view):
    labels = 2 * patch_of(view)
    labels[401:404, 401:404] = 1
    small, patch = doubts_of(view, labels)
    assert small == "only 9 points"
    assert "mm above a surface with" in patch


def test_height_alone_decides_without_colours(view):
    plain = replace(view, cloud=replace(view.cloud, colors=None))
    assert doubts_of(plain) == [""]
    assert doubts_of(plain, patch_of(view))[0]


def test_few_points_are_no_thing_and_a_cut_one_needs_more(view):
    few, cut = np.zeros_like(view.labels), np.zeros_like(view.labels)
    rows, columns = (int(at.mean()) for at in np.nonzero(view.labels))
    few[rows : rows + 9, columns : columns + 9] = 1
    cut[460:480, 300:320] = 1
    assert doubts_of(view, few) == ["only 81 points"]
    assert doubts_of(view, cut) == ["only 400 points at the image edge"]


def test_a_sliver_along_the_line_of_sight_is_no_thing(view):
    depth = view.cloud.points_camera[..., 2].copy()
    sliver = np.zeros_like(view.labels)
    sliver[300:312, 100:112] = 1
    ramp = np.linspace(0.7, 1.0, 144).reshape(12, 12) * np.nanmedian(depth[sliver > 0])
    points = view.cloud.points_camera.copy()
    points[sliver > 0] *= (ramp.ravel() / depth[sliver > 0])[:, None]
    mixed = replace(view, cloud=replace(view.cloud, points_camera=points))
    assert doubts_of(mixed, sliver) == ["a sliver along the line of sight, as between near and far pixels"]


def test_things_of_a_detector_are_not_doubted(view):
    sight = with_labels(view, patch_of(view), frozenset())
    (thing,) = parts_in([sight]).things
    masked = replace(thing, segments=tuple(replace(one, masked=True) for one in thing.segments))
    assert doubts([sight], [sight.labels], [masked]) == [""]


def test_dropped_things_are_listed_with_the_reason(view):
    found = observe_clouds([view.cloud], shipped())
    assert [one.points > 1000 for one in found.observations.observations if max(one.size_m) < 0.5] == [True]
    assert all(reason for _, reason in found.dropped)
