"""Objects in clouds, with the shipped model."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.segmentation import segment
from semmap.nodes.perception_node.segmentation.merge_model import load, save, shipped
from semmap.schemas.errors import BadFile
from tests.perception_node.segmentation.scenes import boxes_on_table
from tests.perception_node.segmentation.test_patches import SCENES


def overlaps(labels, truth, valid):
    """Return for each box the best intersection over union with a segment."""
    labels, truth = labels[valid], truth[valid]
    return [
        max(
            np.sum((truth == box) & (labels == n)) / np.sum((truth == box) | (labels == n))
            for n in range(1, labels.max() + 1)
        )
        for box in range(1, truth.max() + 1)
    ]


@pytest.mark.parametrize("posed", [False, True])
@pytest.mark.parametrize("boxes", SCENES.values(), ids=SCENES)
def test_boxes_are_found(boxes, posed):
    seen = boxes_on_table(*boxes, posed=posed)
    found = segment(seen.cloud)
    valid = np.isfinite(seen.cloud.points_camera[..., 2])
    assert found.labels.dtype == np.int32
    assert found.labels.shape == found.plane_labels.shape == valid.shape
    assert not found.labels[~valid].any()
    assert not (found.labels * found.plane_labels).any()
    assert min(overlaps(found.labels, seen.truth, valid)) > 0.75
    assert [plane.kind for plane in found.planes] == ["floor" if posed else "support"]


def test_a_cloud_without_order_is_segmented_alike():
    seen = boxes_on_table(*SCENES["side by side"])
    points = seen.cloud.points_camera.reshape(-1, 3)
    order = np.random.default_rng(0).permutation(np.flatnonzero(np.isfinite(points[:, 2])))
    found = segment(Cloud(points[order][None]))
    assert found.labels.shape == (1, len(order))
    truth = seen.truth.ravel()[order][None]
    assert min(overlaps(found.labels, truth, truth >= 0)) > 0.75


def test_the_same_cloud_gives_the_same_labels():
    cloud = boxes_on_table(*SCENES["on one another"]).cloud
    np.testing.assert_array_equal(segment(cloud).labels, segment(cloud).labels)


def test_a_plate_lower_than_all_other_things_is_found_beside_a_box():
    plate, box = ((-0.35, -0.1, 0), (-0.2, 0.05, 0.006)), ((0.1, -0.1, 0), (0.2, 0, 0.1))
    seen = boxes_on_table(plate, box)
    found = segment(seen.cloud)
    assert found.labels.max() == 2
    assert min(overlaps(found.labels, seen.truth, seen.truth >= 0)) > 0.7


@pytest.mark.parametrize("shape", [(1, 0), (0, 0), (1, 1), (1, 3), (2, 2), (480, 640)])
@pytest.mark.parametrize("value", [np.nan, 0.0, -1.0])
def test_clouds_with_nothing_in_them(shape, value):
    found = segment(Cloud(np.full((*shape, 3), value, np.float32)))
    assert found.labels.shape == shape
    assert not found.labels.any()


@pytest.mark.parametrize("shape", [(1, 1), (1, 3), (1, 100), (2, 2), (1, 2), (240, 320)])
def test_one_point_many_times_is_no_trouble(shape):
    assert segment(Cloud(np.ones((*shape, 3), np.float32))).labels.shape == shape


def test_noise_is_no_trouble():
    rng = np.random.default_rng(0)
    for shape in ((1, 500), (60, 80), (750, 1000)):
        found = segment(Cloud(rng.normal(1, 1, (*shape, 3)).astype(np.float32)))
        assert found.labels.shape == shape


def test_colours_are_no_must():
    seen = boxes_on_table(*SCENES["apart"])
    colors = np.full((*seen.truth.shape, 3), 128, np.uint8)
    assert segment(replace(seen.cloud, colors=colors)).labels.max() == segment(seen.cloud).labels.max() == 2


def test_what_is_learnt_comes_back_from_its_file(tmp_path):
    save(shipped(), tmp_path / "learnt.npz")
    again = load(tmp_path / "learnt.npz")
    assert again.story == shipped().story
    rows = np.random.default_rng(0).normal(size=(20, 60)).astype(np.float32)
    np.testing.assert_array_equal(again.trees.probability(rows), shipped().trees.probability(rows))


def test_a_file_of_something_else_is_refused(tmp_path):
    file = tmp_path / "learnt.npz"
    for content in (b"", b"no archive"):
        file.write_bytes(content)
        with pytest.raises(BadFile, match=r"learnt\.npz"):
            load(file)
    np.savez(file, a=np.zeros(1))
    with pytest.raises(BadFile, match=r"learnt\.npz"):
        load(file)
    with pytest.raises(BadFile, match="missing"):
        load(tmp_path / "missing.npz")
