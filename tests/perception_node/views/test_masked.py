"""Masks of an external detector, made from the simulator's ground truth with noise."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import ndimage

from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.input.masks import DetectorLabel, Masks
from semmap.nodes.perception_node.pipeline import observe_clouds
from semmap.nodes.perception_node.recognition.detector_labels import LabelMap
from semmap.nodes.perception_node.recognition.recognition_model import shipped
from semmap.nodes.perception_node.views.masked import with_masks
from semmap.nodes.perception_node.views.segmented_view import (
    SegmentedView,
    segment_cloud,
    with_labels,
)
from tests.perception_node.scenes import KINDS, shot

CLASSES = {"cereals": "Cereals", "apple": "Apple", "bottle": "Bottle", "basket": "Basket"}


def masks(view, *, names=CLASSES, grown=2, alone=False, score=0.8):
    """Return the ground-truth masks enlarged by a few pixels, so that their rims lie on the background."""
    taken = shot()
    labels = np.zeros(taken.owners[view].shape, np.int32)
    said = []
    for body, name in names.items():
        number = next(n for n, b in enumerate(taken.bodies, 1) if b.name == body)
        said.append(DetectorLabel(name, score) if name else None)
        labels[ndimage.binary_dilation(taken.owners[view] == number, iterations=grown)] = len(said)
    return Masks(labels, tuple(said), alone)


def owner_of(segment_pixels, view):
    counts = np.bincount(shot().owners[view][segment_pixels])
    return shot().bodies[int(counts.argmax()) - 1].name, counts.max() / counts.sum()


def test_segments_are_the_masks_without_what_lies_behind_them():
    sight = with_masks(segment_cloud(shot().clouds[0]), masks(0, alone=True))
    assert len(sight.segments) == len(KINDS)
    assert all(segment.masked for segment in sight.segments)
    for segment, (body, name) in zip(sight.segments, CLASSES.items(), strict=True):
        found, purity = owner_of(sight.labels == segment.label, 0)
        assert (found, segment.detector_label.label) == (body, name)
        assert purity > 0.9


def test_beside_masks_our_own_segments_remain():
    only_apple = masks(0, names={"apple": "Apple"})
    sight = with_masks(segment_cloud(shot().clouds[0]), only_apple)
    found = {owner_of(sight.labels == segment.label, 0)[0] for segment in sight.segments}
    assert found >= {*KINDS, "table"}
    assert [segment.masked for segment in sight.segments].count(True) == 1


def test_numbers_that_a_label_image_skips_are_not_unused_masks():
    found = masks(0, names={"apple": None}, alone=True)
    skipping = Masks(found.labels * 40, (None,) * 40, alone=True)
    sight = with_masks(segment_cloud(shot().clouds[0]), skipping)
    assert (len(sight.segments), sight.unused_masks) == (1, ())


def test_names_of_a_detector_count_and_its_things_are_no_clutter():
    both = [masks(0, alone=True), masks(1, alone=True)]
    seen = observe_clouds(shot().clouds, shipped(), both).observations.observations
    assert sorted(o.class_ for o in seen) == sorted(CLASSES.values())
    assert all(o.probability > 0.8 for o in seen)


def test_a_map_of_labels_and_labels_that_nobody_knows():
    learnt = shipped()
    labels = LabelMap(learnt, {"Granny Smith": "Apple", "spork": "Spork"})
    assert labels.class_of("granny_smith") == "Apple"
    assert labels.class_of("WINE-bottle") == labels.class_of("winebottle")
    assert labels.class_of("gizmo") is None
    names = {"apple": "Granny Smith", "bottle": "spork", "cereals": "gizmo"}
    seen = observe_clouds(shot().clouds[:1], learnt, [masks(0, names=names, alone=True, score=0.999)], labels)
    said = {o.class_: o.probability for o in seen.observations.observations}
    assert said["Apple"] > 0.8
    assert said["Spork"] == pytest.approx(0.999)
    assert len(said) == 3


def test_a_detector_that_is_unsure_does_not_overrule_what_is_plain():
    wrong = masks(0, names={"bottle": "Fork"}, alone=True, score=0.05)
    (seen,) = observe_clouds(shot().clouds[:1], shipped(), [wrong]).observations.observations
    assert seen.class_ != "Fork"


def test_masks_of_another_size_are_refused():
    small = Masks(np.zeros((240, 320), np.int32), ())
    with pytest.raises(ValueError, match="320 x 240 pixels, the image 640 x 480"):
        with_masks(segment_cloud(shot().clouds[0]), small)


def test_a_general_label_of_things_of_another_class_stays_general():
    told = masks(0, names=dict.fromkeys(CLASSES, "Toy"), alone=True)
    found = observe_clouds([shot().clouds[0]], shipped(), [told]).observations.observations
    assert [one.class_ for one in found] == ["Toy"] * len(CLASSES)
    for one in found:
        assert one.candidates["Toy"] == pytest.approx(one.probability)
        assert "Ball" not in one.candidates


TOP, CUP_ON_IT, BOX_BESIDE = np.s_[20:40, 0:30], np.s_[22:30, 4:12], np.s_[4:14, 34:44]
CUP = DetectorLabel("cup", 0.9)


def drawn(*windows, shape=(40, 50)):
    """Return an image in which the pixels of the n-th window are n."""
    numbers = np.zeros(shape, np.int32)
    for number, window in enumerate(windows, 1):
        numbers[window] = number
    return numbers


def drawn_view(*, far=None):
    """Return a view of a top, a cup on it and a box, on a wall 1 m away; pixels of `far` are 2 m away."""
    labels = drawn(TOP, CUP_ON_IT, BOX_BESIDE)
    row, column = np.indices(labels.shape) / 100.0
    points = np.stack([column, row, np.ones(labels.shape)], axis=-1).astype(np.float32)
    if far is not None:
        points[far][..., 2] = 2.0
    planes, none = drawn(np.s_[0:40, 30:50]), np.zeros((0, 0), np.float32)
    sight = SegmentedView(Cloud(points), np.eye(4), labels, frozenset({1}), planes, (), none)
    return with_labels(sight, labels, frozenset({1}))


def masked(*windows, alone=False, far=None):
    numbers = drawn(*windows)
    return with_masks(drawn_view(far=far), Masks(numbers, (CUP,) * len(windows), alone))


def test_our_segments_remain_unless_masks_cover_half_of_them():
    left_half = np.s_[20:40, 0:14]
    found = masked(left_half)
    assert [(one.count, one.masked, one.carrier) for one in found.segments] == [
        (280, True, False),
        (320, False, True),
        (100, False, False),
    ]
    assert found.carriers == {2}
    more = masked(np.s_[20:40, 0:18])
    assert [one.count for one in more.segments] == [360, 100]
    assert [one.count for one in masked(left_half, alone=True).segments] == [280]


@pytest.mark.parametrize(("window", "is_top"), [(np.s_[20:40, 0:20], True), (np.s_[20:40, 0:16], False)])
def test_a_mask_of_most_of_a_top_is_one(window, is_top):
    found = masked(window, alone=True)
    assert found.carriers == ({1} if is_top else set())
    assert found.segments[0].carrier is is_top


@pytest.mark.parametrize(
    ("window", "count"),
    [(np.s_[0:10, 20:40], 100), (np.s_[0:10, 24:40], 160), (np.s_[0:10, 40:50], 100)],
    ids=["half beside a plane", "mostly on a plane", "flat on a plane"],
)
def test_pixels_of_a_plane_behind_do_not_belong_to_a_mask_unless_it_lies_on_it(window, count):
    assert masked(window, alone=True).segments[0].count == count


def test_a_mask_is_the_largest_part_of_it_without_a_step_in_depth():
    across, down = np.s_[0:10, 3:10], np.s_[0:3, 0:10]
    assert masked(np.s_[0:10, 0:10], alone=True).segments[0].count == 100
    assert masked(np.s_[0:10, 0:10], alone=True, far=across).segments[0].count == 70
    assert masked(np.s_[0:10, 0:10], alone=True, far=down).segments[0].count == 70
    assert masked(np.s_[0:10, 0:10], alone=True, far=np.s_[4, 4]).segments[0].count == 97


def test_a_mask_of_fewer_than_twenty_points_is_not_used():
    found = masked(np.s_[0:4, 0:5], np.s_[10:11, 0:19], alone=True)
    assert (len(found.segments), found.unused_masks) == (1, (2,))
    assert found.segments[0].detector_label == CUP
