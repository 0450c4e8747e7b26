from __future__ import annotations

import json

import numpy as np
import pytest
from PIL import Image

from semmap.nodes.perception_node.input.files.mask_files import read_masks
from semmap.nodes.perception_node.input.masks import DetectorLabel
from semmap.schemas.errors import BadFile

LABELS = np.array([[0, 1, 1], [0, 2, 2]])
FIRST = {"segmentation": {"size": [2, 3], "counts": [2, 1, 1, 1, 1]}, "score": 0.7}


def test_results_and_datasets_of_coco(tmp_path):
    (tmp_path / "a.json").write_text(json.dumps([{**FIRST, "category": "cup"}, {**FIRST, "category_id": 7}]))
    results = read_masks(tmp_path / "a.json", 2, 3)
    assert results.detector_labels == (DetectorLabel("cup", 0.7), DetectorLabel("7", 0.7))
    dataset = {"categories": [{"id": 7, "name": "coffee mug"}], "annotations": [{**FIRST, "category_id": 7}]}
    (tmp_path / "b.json").write_text(json.dumps(dataset))
    found = read_masks(tmp_path / "b.json", 2, 3)
    assert found.detector_labels == (DetectorLabel("coffee mug", 0.7),)
    assert found.labels.tolist() == [[0, 1, 1], [0, 0, 0]]


@pytest.mark.parametrize("mark", ["utf-8-sig", "utf-16"])
def test_a_byte_order_mark_is_ignored(tmp_path, mark):
    (tmp_path / "a.json").write_text(json.dumps([{**FIRST, "category": "cup"}]), mark)
    assert read_masks(tmp_path / "a.json", 2, 3).detector_labels == (DetectorLabel("cup", 0.7),)


def test_yolo_s_files_may_have_a_byte_order_mark(tmp_path):
    (tmp_path / "a.txt").write_text("0 0 0 1 0 1 1 0.9\n", "utf-8-sig")
    (tmp_path / "classes.txt").write_text("cup\n", "utf-8-sig")
    assert read_masks(tmp_path / "a.txt", 2, 3).detector_labels == (DetectorLabel("cup", 0.9),)


@pytest.mark.parametrize(
    ("polygons", "pixels"),
    [
        ([[1, 0, 3, 0, 3, 2, 1, 2]], [[0, 1, 1, 0], [0, 1, 1, 0], [0, 0, 0, 0]]),
        ([[0, 0, 1, 0, 1, 3, 0, 3], [3, 0, 4, 0, 4, 1, 3, 1]], [[1, 0, 0, 1], [1, 0, 0, 0], [1, 0, 0, 0]]),
        ([[0, 0, 4, 0, 0, 3]], [[1, 1, 1, 0], [1, 1, 0, 0], [1, 0, 0, 0]]),
        ([[-5, -5, 9, -5, 9, 9, -5, 9]], [[1] * 4] * 3),
        ([[0, 0, 4, 0, 4, 3, 3, 3, 3, 1, 1, 1, 1, 3, 0, 3]], [[1] * 4, [1, 0, 0, 1], [1, 0, 0, 1]]),
        ([[5, 0, 7, 0, 7, 2]], [[0] * 4] * 3),
    ],
)
def test_polygons_hold_the_pixels_whose_middle_is_within(tmp_path, polygons, pixels):
    (tmp_path / "a.json").write_text(json.dumps([{"segmentation": polygons, "category": "cup"}]))
    found = read_masks(tmp_path / "a.json", 3, 4)
    assert found.labels.tolist() == pixels
    assert found.detector_labels == (DetectorLabel("cup", 1.0),)


def test_shapes_of_labelme(tmp_path):
    polygon = {"label": "mug", "points": [[0, 0], [1, 0], [1, 2], [0, 2]], "shape_type": "polygon"}
    rectangle = {"label": "box", "points": [[3, 2], [1, 1]], "shape_type": "rectangle"}
    (tmp_path / "a.json").write_text(json.dumps({"version": "5", "shapes": [polygon, rectangle]}))
    found = read_masks(tmp_path / "a.json", 2, 3)
    assert found.labels.tolist() == [[1, 0, 0], [1, 2, 2]]
    assert [one.label for one in found.detector_labels] == ["mug", "box"]


@pytest.mark.parametrize(
    "content",
    [
        {"imageWidth": 6, "imageHeight": 4, "shapes": []},
        {"images": [{"id": 1, "width": 6, "height": 4}], "annotations": []},
    ],
)
def test_masks_for_an_image_of_another_size_are_invalid(tmp_path, content):
    (tmp_path / "a.json").write_text(json.dumps(content))
    with pytest.raises(BadFile, match="its masks are for an image of 6 x 4 pixels, not 3 x 2"):
        read_masks(tmp_path / "a.json", 2, 3)
    assert read_masks(tmp_path / "a.json", 4, 6).detector_labels == ()


def test_a_label_image_in_an_archive_has_its_things(tmp_path):
    np.savez(tmp_path / "a.npz", masks=LABELS, names=np.array([b"mug", b"box"]), scores=[[0.9], [0.8]])
    found = read_masks(tmp_path / "a.npz", 2, 3)
    assert found.labels.tolist() == LABELS.tolist()
    assert found.detector_labels == (DetectorLabel("mug", 0.9), DetectorLabel("box", 0.8))


def test_one_mask_has_one_name_and_may_be_of_probabilities(tmp_path):
    np.savez(tmp_path / "a.npz", masks=np.array([[0.0, 0.2, 0.9], [0.1, 0.6, 1.0]])[None], names="mug")
    found = read_masks(tmp_path / "a.npz", 2, 3)
    assert found.labels.tolist() == [[0, 0, 1], [0, 1, 1]]
    assert found.detector_labels == (DetectorLabel("mug", 1.0),)


@pytest.mark.parametrize("place", [None, "frame", "."])
def test_lines_of_yolo(tmp_path, place):
    (tmp_path / "frame").mkdir()
    if place is not None:
        (tmp_path / place / "classes.txt").write_text("mug\npower drill\n")
    path = tmp_path / "frame" / "a.txt"
    path.write_text("0 0 0 0.34 0 0.34 1 0 1 0.8\n\n1 0.67 0.75 0.66 0.5\n")
    found = read_masks(path, 2, 3)
    assert found.labels.tolist() == [[1, 0, 0], [1, 2, 2]]
    names = ("mug", "power drill") if place else ("0", "1")
    assert found.detector_labels == (DetectorLabel(names[0], 0.8), DetectorLabel(names[1], 1.0))
    path.write_text("")
    assert read_masks(path, 2, 3).detector_labels == ()


def test_a_mask_for_each_thing(tmp_path):
    stack = np.array([LABELS > 0, LABELS == 2])
    np.save(tmp_path / "a.npy", stack)
    np.save(tmp_path / "b.npy", np.moveaxis(stack, 0, 2))
    for name in ("a.npy", "b.npy"):
        found = read_masks(tmp_path / name, 2, 3)
        assert found.labels.tolist() == LABELS.tolist()
        assert found.detector_labels == (None, None)
    np.savez(tmp_path / "a.npz", masks=stack, names=["mug", "power drill"], scores=[0.9, 0.8])
    found = read_masks(tmp_path / "a.npz", 2, 3)
    assert found.labels.tolist() == (LABELS > 0).tolist()
    assert found.detector_labels == (DetectorLabel("mug", 0.9), DetectorLabel("power drill", 0.8))
    np.save(tmp_path / "c.npy", LABELS == 2)
    assert read_masks(tmp_path / "c.npy", 2, 3).labels.tolist() == (LABELS == 2).tolist()


@pytest.mark.parametrize(
    ("arrays", "said"),
    [
        ({"masks": np.ones((2, 4, 3), bool)}, "an array N x 2 x 3; this one is 2 x 4 x 3"),
        ({"masks": np.ones((2, 2, 3), bool), "names": ["mug"]}, "2 masks and 1 names"),
        ({"masks": np.ones((1, 2, 3), bool), "scores": [9.0]}, "from 0 to 1"),
        ({"segments": np.ones((1, 2, 3), bool)}, "no array named masks, only segments"),
    ],
)
def test_masks_that_do_not_fit_are_told(tmp_path, arrays, said):
    np.savez(tmp_path / "a.npz", **arrays)
    with pytest.raises(BadFile, match=said):
        read_masks(tmp_path / "a.npz", 2, 3)


def test_label_images(tmp_path):
    np.save(tmp_path / "a.npy", LABELS)
    Image.fromarray(LABELS.astype(np.uint8)).save(tmp_path / "a.png")
    for name in ("a.npy", "a.png"):
        found = read_masks(tmp_path / name, 2, 3)
        assert found.labels.tolist() == LABELS.tolist()
        assert found.detector_labels == (None, None)


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("a.json", b"{", "not JSON"),
        ("a.json", b"[" * 100_000, "not JSON: nested too deeply"),
        ("a.json", b"{}", "expected a list of masks"),
        ("a.json", b"[3]", "needs a segmentation"),
        ("a.json", b'[{"segmentation": [[1, 2, 3]]}]', "polygon needs x and y of at least three corners"),
        ("a.json", b'[{"segmentation": [[0, 0, 9e9, 0, 9, 9]]}]', "far outside the image"),
        ("a.json", b'[{"segmentation": []}]', "or a list of polygons"),
        ("a.json", b'[{"segmentation": {"size": [2, 2], "counts": [4]}}]', "2 x 2 pixels"),
        ("a.json", b'[{"segmentation": {"size": "x", "counts": [4]}}]', r"a\.json: a mask's size must be"),
        (
            "a.json",
            b'[{"segmentation": {"size": [2, 3], "counts": [6]}, "score": 90}]',
            r"a mask's score must be a number from 0 to 1",
        ),
        ("a.json", b'{"categories": [3], "annotations": []}', "categories are a list such as"),
        ("a.json", b'[{"image_id": 1}, {"image_id": 2}]', "masks of 2 images"),
        ("a.json", b'[{"segmentation": {"size": [2, 3], "counts": [%d, 3]}}]' % 10**30, "add up to"),
        ("a.json", b'[{"segmentation": {"size": [2, 3], "counts": "%s0"}}]' % (b"o" * 40), "add up to"),
        ("a.npy", b"nothing", r"a\.npy: not a valid \.npy array"),
        ("a.npy", b"\x93NUMPY\x01\x00\xff\xff" + b"(" * 65_535, r"may not be safe to load securely\.$"),
        ("a.gif", b"", "masks are"),
        ("a.txt", b"0 0.1 0.1 0.2", "line 1 is not a class, x and y"),
        ("a.txt", b"0 0 0 1 0 1 1\ncup 0 0 1 0 1 1", "line 2 is not a class"),
        ("a.txt", b"0 0 0 1 0 1 1 7", "line 1"),
        ("a.json", b'{"shapes": [{"label": "cup"}]}', "each shape needs a label and points"),
        ("a.json", b'{"shapes": [{"points": [[1, 2], 3, 4]}]}', "pairs of numbers"),
        ("a.json", b'{"shapes": [{"points": [[1, 2]], "shape_type": "circle"}]}', "'circle'; use polygon"),
        ("a.npz", b"PK no archive", "not an .npz archive"),
    ],
)
def test_what_is_wrong_is_said_with_the_file(tmp_path, name, content, said):
    (tmp_path / name).write_bytes(content)
    with pytest.raises(BadFile, match=said):
        read_masks(tmp_path / name, 2, 3)


def test_images_of_another_size_or_of_no_numbers(tmp_path):
    np.save(tmp_path / "a.npy", LABELS)
    with pytest.raises(BadFile, match="3 x 3 integers; this one has 3 x 2 of"):
        read_masks(tmp_path / "a.npy", 3, 3)
    np.save(tmp_path / "c.npy", LABELS * 10**9)
    with pytest.raises(BadFile, match="has 2000000000 things; the maximum is 65535"):
        read_masks(tmp_path / "c.npy", 2, 3)
    np.save(tmp_path / "b.npy", LABELS / 2)
    with pytest.raises(BadFile, match="float64"):
        read_masks(tmp_path / "b.npy", 2, 3)
    with pytest.raises(BadFile, match="cannot be read"):
        read_masks(tmp_path / "missing.png", 2, 3)


def test_an_array_is_only_read_as_far_as_its_file_goes(tmp_path):
    """A header may claim any size, and an array of objects is a program."""
    path = tmp_path / "masks.npy"
    with path.open("wb") as file:
        header = {"descr": "<i8", "fortran_order": False, "shape": (10**6, 10**6)}
        np.lib.format.write_array_header_1_0(file, header)
    with pytest.raises(BadFile, match=r"masks\.npy: "):
        read_masks(path, 10**6, 10**6)
    np.save(path, np.array([[print, 1]], dtype=object), allow_pickle=True)
    with pytest.raises(BadFile, match=r"masks\.npy: .*objects"):
        read_masks(path, 1, 2)
    for content in (
        b"",
        b"\x93NUMPY",
        b"\x93NUMPY\x01\x00\xff\xff",
        b"\x93NUMPY\x09\x00v\x00{",
        b"PK\x03\x04",
    ):
        path.write_bytes(content)
        with pytest.raises(BadFile, match=r"masks\.npy: "):
            read_masks(path, 1, 2)
