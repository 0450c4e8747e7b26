"""Datasets: rows of frames, also of invalid and of strange ones."""

from __future__ import annotations

import json

import msgspec
import numpy as np
import pytest
from PIL import Image

from semmap.nodes.perception_node import datasets
from semmap.nodes.perception_node.detector import Detector
from semmap.nodes.perception_node.input.files.frame_folders import FileFrame
from semmap.nodes.perception_node.input.masks import DetectorLabel, Masks
from semmap.nodes.perception_node.input.projection import cloud_of
from semmap.nodes.perception_node.recognition.detector_labels import LabelMap
from semmap.nodes.perception_node.recognition.recognition_model import shipped
from semmap.schemas.perception import FrameRow
from tests.perception_node.segmentation.scenes import FOCAL_PX, HEIGHT, WIDTH, boxes_on_table
from tests.perception_node.segmentation.test_patches import SCENES


def write_frame(folder, depth_m):
    folder.mkdir(parents=True)
    height, width = depth_m.shape
    Image.fromarray((np.nan_to_num(depth_m) * 1000).round().astype(np.uint16)).save(folder / "depth.png")
    Image.new("RGB", (width, height), (120, 120, 120)).save(folder / "rgb.png")
    focal_px = FOCAL_PX * width / WIDTH
    camera = {"fx": focal_px, "fy": focal_px, "cx": width / 2, "cy": height / 2}
    (folder / "camera.json").write_text(json.dumps(camera | {"depth_scale": 0.001}))
    return folder


def depth_of(*boxes):
    return boxes_on_table(*boxes).cloud.points_camera[..., 2]


def rows(folders, detector=None):
    found = [found.row for found in datasets.perceive_folders(folders, shipped(), detector)]
    return msgspec.json.decode(msgspec.json.encode(found), type=list[FrameRow])


def test_an_unexpected_error_of_a_frame_is_in_its_row(tmp_path, monkeypatch):
    folders = [write_frame(tmp_path / name, depth_of(*SCENES["apart"])) for name in "abc"]
    observe, calls = datasets.observe_clouds, []

    def fails_once(clouds, *others):
        calls.append(1)
        if len(calls) == 1:
            raise IndexError("index -9223372036854775808 is out of bounds")
        return observe(clouds, *others)

    monkeypatch.setattr(datasets, "observe_clouds", fails_once)
    found = rows(folders)
    assert [row.frame for row in found] == ["a", "b", "c"]
    (failed,) = [row for row in found if row.error]
    assert failed.error == (
        f"{failed.frame}: processing failed: IndexError: index -9223372036854775808 is out of bounds;"
        " report it with this frame"
    )
    assert all(row.objects for row in found if not row.error)


def odd_depths():
    """Return depth images (H, W) [m] that a camera may well give."""
    rng = np.random.default_rng(0)
    table = depth_of(*SCENES["apart"])
    column = np.full((60, 80), np.nan, np.float32)
    column[:, 40] = 1.0
    return {
        "one pixel": np.full((1, 1), 1.0),
        "one row": np.full((1, 80), 1.0),
        "one column": np.full((80, 1), 1.0),
        "a visible column": column,
        "nothing": np.zeros((60, 80)),
        "all near": np.full((60, 80), 0.005),
        "all far": np.full((60, 80), 65.0),
        "holes": np.where(rng.random(table.shape) < 0.7, np.nan, table),
        "noise": rng.uniform(0.4, 4.0, (240, 320)),
        "steps": np.kron(rng.uniform(0.4, 4.0, (6, 8)), np.ones((20, 20))),
        "stripes": np.where(np.arange(640) % 16 < 8, np.nan, table),
    }


@pytest.mark.parametrize("name", odd_depths())
def test_a_strange_frame_is_processed_or_told_to_be_invalid(tmp_path, name):
    (row,) = rows([write_frame(tmp_path / "a", odd_depths()[name])])
    assert "processing failed" not in row.error


def test_clutter_is_listed_with_its_place_and_reason(tmp_path):
    cut_by_the_edge = ((-0.8, 0.1, 0.0), (-0.45, 0.14, 0.02))
    (found,) = rows([write_frame(tmp_path / "a", depth_of(cut_by_the_edge, *SCENES["apart"]))])
    assert found.dropped
    for one in found.dropped:
        left, top, right, bottom = one.box_px
        assert 0 <= left < right <= WIDTH
        assert 0 <= top < bottom <= HEIGHT
        assert one.reason.startswith("classified as clutter (0.")


def test_a_mask_without_depth_is_listed(tmp_path):
    depth = depth_of(*SCENES["apart"])
    depth[:50, :60] = np.nan
    folder = write_frame(tmp_path / "a", depth)
    (folder / "masks.json").write_text(
        json.dumps([{"segmentation": [[10, 10, 50, 10, 50, 40, 10, 40]], "label": "cup", "score": 0.9}])
    )
    (row,) = rows([folder], Detector(folder / "masks.json", LabelMap(shipped())))
    assert [one.reason for one in row.dropped if "mask" in one.reason] == [
        "mask 1 ('cup') covers fewer than 20 points of one surface"
    ]
    (told,) = [one for one in row.dropped if "mask" in one.reason]
    assert (told.box_px, told.points) == ((10, 10, 50, 40), 0)


class BoxDetector:
    """A detector that finds the same boxes in every image, in every second pixel."""

    labels = LabelMap(shipped())

    def masks_of(self, cloud, shape, step, folder):
        self.seen = shape, step, folder.name
        boxes = ((10, 8, 20, 18), (300, 5, 310, 15))
        labels = DetectorLabel("cup", 0.9), DetectorLabel("mug", 0.8)
        return Masks(np.zeros(cloud.points_camera.shape[:2], np.int32), labels, boxes=boxes)


def test_a_box_without_a_thing_is_listed_with_its_place_in_the_whole_image(tmp_path, monkeypatch):
    monkeypatch.setattr(datasets, "read_frame", lambda folder: thinned_frame())
    detector = BoxDetector()
    (row,) = rows([tmp_path / "a"], detector)
    assert detector.seen == ((61, 605), 2, "a")
    fault = "has no segment that fits it: the thing is flat, hidden, or without depth"
    assert [(one.reason, one.box_px, one.points) for one in row.dropped] == [
        (f"box 1 ('cup') {fault}", (20, 16, 40, 36), 0),
        (f"box 2 ('mug') {fault}", (600, 10, 605, 30), 0),
    ]


def thinned_frame():
    """Return the frame of every second pixel of a wall, in an image of 605 x 61."""
    intrinsics = np.array([[300.0, 0, 151.5], [0, 300.0, 15.5], [0, 0, 1]])
    cloud = cloud_of(np.full((31, 303), 1.0, np.float32), None, intrinsics, None)
    return FileFrame(cloud, 2, (61, 605))
