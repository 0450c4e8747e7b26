"""Things stand out from the surface around them, by height or colour; noise does not."""

from dataclasses import replace

import numpy as np
import pytest

from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.pipeline import observe_clouds, parts_in
from semmap.nodes.perception_node.recognition.recognition_model import shipped
from semmap.nodes.perception_node.views.protrusion import doubts
from semmap.nodes.perception_node.views.segmented_view import SegmentedView, segment_cloud, with_labels
from semmap.nodes.perception_node.views.supports import Support
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


BARE = 400


def level_view(side, *, rise_m=0.0, shade=120, dips_m=0.0, around=True, tall_cells=None):
    """Return a view from 1 m above a level surface with a square patch that rises, of another brightness."""
    labels = np.zeros((160, 160), np.int32)
    labels[80 : 80 + side, 80 : 80 + side] = 1
    height = np.where(labels > 0, rise_m, 0.0)
    if tall_cells is not None:  # of those that are compared, in the first row of the patch
        height[84:, 80:] = height[80:, 80 + 4 * tall_cells :] = 0.0
    height[::8, :40] -= dips_m
    if not around:
        height[labels == 0] = np.nan
    u, v = np.meshgrid(*[(np.arange(160) - 80) / BARE] * 2)
    depth = 1.0 - height
    points = np.stack([u * depth, v * depth, depth], axis=-1).astype(np.float32)
    colors = np.where(labels > 0, shade, 120).astype(np.uint8)[..., None].repeat(3, axis=-1)
    pose = np.diag([1.0, -1.0, -1.0, 1.0])
    pose[2, 3] = 1.0
    nothing, alone = np.zeros_like(labels), np.zeros((1, 1), np.float32)
    cloud = Cloud(points, colors, pose)
    sight = SegmentedView(cloud, pose, labels, frozenset(), nothing, (Support(0.0),), alone)
    return with_labels(sight, labels, frozenset())


@pytest.mark.parametrize(
    ("side", "patch", "doubt"),
    [
        (20, {}, "rises 0 mm above a surface with 3 mm of noise"),
        (20, {"rise_m": 0.01}, "rises 10 mm above a surface with 3 mm of noise"),
        (20, {"rise_m": 0.013}, ""),
        (20, {"rise_m": 0.013, "dips_m": 0.006}, "rises 13 mm above a surface with 6 mm of noise"),
        (20, {"rise_m": 0.013, "tall_cells": 3}, ""),
        (20, {"rise_m": 0.013, "tall_cells": 2}, "rises 0 mm above a surface with 3 mm of noise"),
        (20, {"shade": 126}, "rises 0 mm above a surface with 3 mm of noise"),
        (20, {"shade": 140}, ""),
        (20, {"rise_m": 0.009, "shade": 126}, ""),
        (16, {"rise_m": 0.015}, "rises 15 mm above a surface with 3 mm of noise"),
        (16, {"rise_m": 0.026}, ""),
        (16, {"shade": 140}, "rises 0 mm above a surface with 3 mm of noise"),
        (20, {"around": False}, ""),
        (9, {"rise_m": 0.1}, "only 81 points"),
    ],
)
def test_height_and_colour_add_up_and_a_small_thing_needs_twice_as_much(side, patch, doubt):
    (found,) = doubts_of(level_view(side, **patch))
    assert found.split(",")[0] == doubt


def test_a_thing_must_stand_out_in_one_of_its_views_only():
    flat, raised = level_view(20), level_view(20, rise_m=0.02)
    things = parts_in([flat]).things
    assert doubts([flat, raised], [flat.labels, raised.labels], things) == [""]
    (doubt,) = doubts([flat, flat], [flat.labels, flat.labels], things)
    assert doubt.startswith("rises 0 mm")
    alone = level_view(20, around=False)
    assert doubts([flat, alone], [flat.labels, alone.labels], things) == [""]


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
