"""Cameras in the files of several programs."""

import json

import numpy as np
import pytest

from semmap.nodes.perception_node.input.files.camera_files import (
    PinholeCamera,
    pose_of,
    read_camera,
)

POSE = np.array([[0.0, -1, 0, 1], [1, 0, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]])
K = [525.0, 0, 319.5, 0, 520.0, 239.5, 0, 0, 1]
BY_COLUMN = np.reshape(K, (3, 3)).T.ravel().tolist()
CALIBRATION = """%YAML:1.0
---
# made by a calibration
image_width: 640
image_height: 480
camera_name: narrow
camera_matrix: !!opencv-matrix
  rows: 3
  cols: 3
  dt: d
  data: [525.0, 0., 319.5,
         0., 5.2e2, 239.5, 0., 0., 1.]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [0, 0, 0, 0, 0]
"""
MESSAGE = """header:
  seq: 17
  stamp:
    secs: 1500000000
height: 480
width: 640
distortion_model: "plumb_bob"
d:
- 0.1
- -0.2
k:
- 600.0
- 0.0
- 310.0
- 0.0
- 600.0
- 230.0
- 0.0
- 0.0
- 1.0
p:
- 525.0
- 0.0
- 319.5
- 0.0
- 0.0
- 520.0
- 239.5
- 0.0
- 0.0
- 0.0
- 1.0
- 0.0
roi:
  height: 0
  width: 0
---
"""


def camera(folder, **numbers):
    path = folder / "camera.json"
    path.write_text(json.dumps({"fx": 50, "fy": 40, "cx": 19.5, "cy": 14.5} | numbers))
    return path


@pytest.mark.parametrize(
    ("content", "size"),
    [
        pytest.param({"width": 640, "height": 480, "intrinsic_matrix": BY_COLUMN}, True, id="Open3D"),
        pytest.param({"K": K}, False, id="K"),
        pytest.param(
            {"K": np.reshape(K, (3, 3)).tolist(), "width": 640, "height": 480}, True, id="rows of K"
        ),
        pytest.param(np.reshape(K, (3, 3)).tolist(), False, id="a list of rows"),
        pytest.param(
            {
                "width": 640,
                "height": 480,
                "fx": 525,
                "fy": 520,
                "ppx": 319.5,
                "ppy": 239.5,
                "coeffs": [0] * 5,
            },
            True,
            id="RealSense",
        ),
        pytest.param("525 0 319.5\n0 520 239.5\n0 0 1\n", False, id="matrix"),
        pytest.param("525 0 319.5 0\n0 520 239.5 0\n0 0 1 0\n0 0 0 1\n", False, id="4 x 4"),
        pytest.param("[[525.   0. 319.5]\n [  0. 520. 239.5]\n [  0.   0.   1. ]]\n", False, id="printed"),
        pytest.param(CALIBRATION, True, id="calibration"),
        pytest.param(MESSAGE, True, id="message"),
    ],
)
def test_a_camera_of_another_program_is_read(tmp_path, content, size):
    path = tmp_path / "camera.txt"
    path.write_text(content if isinstance(content, str) else json.dumps(content))
    found = read_camera(path)
    assert (found.fx, found.fy, found.cx, found.cy) == (525.0, 520.0, 319.5, 239.5)
    assert found.size == ((640, 480) if size else None)


def test_scale_and_pose_stand_beside_a_matrix(tmp_path):
    path = tmp_path / "camera.json"
    path.write_text(json.dumps({"K": K, "depth_scale": 0.0002, "map_from_camera": POSE.tolist()}))
    found = read_camera(path)
    assert found.depth_scale == 0.0002
    assert pose_of(found.map_from_camera) == pytest.approx(POSE)


@pytest.mark.parametrize(
    "content",
    [
        "",
        "[]",
        "{}",
        "1 2 3",
        "hello",
        '{"K": [1, 2]}',
        '{"K": null}',
        "K: [1, 2, 3]",
        "[" * 100_000,
        "525 9 3 0 525 2 0 0 1",
    ],
)
def test_what_is_no_camera_is_refused(tmp_path, content):
    path = tmp_path / "camera.yaml"
    path.write_text(content)
    with pytest.raises(ValueError, match="invalid intrinsics"):
        read_camera(path)


def test_a_file_of_something_else_is_refused(tmp_path):
    path = tmp_path / "camera.yaml"
    path.write_bytes(b"\x89PNG\xff\xfe")
    with pytest.raises(ValueError, match="invalid intrinsics: not text"):
        read_camera(path)


@pytest.mark.parametrize("folder", ["plain", "frame"])
@pytest.mark.parametrize("mark", ["utf-8-sig", "utf-16"])
def test_a_byte_order_mark_is_ignored(tmp_path, mark, folder):
    path = tmp_path / "camera.json"
    if folder == "frame":
        (tmp_path / "depth.png").touch()
    for text in (json.dumps({"fx": 525, "fy": 520, "cx": 1, "cy": 1}), json.dumps({"K": K}), CALIBRATION):
        path.write_text(text, mark)
        assert read_camera(path).fx == 525


def test_the_camera_of_a_frame_has_its_own_origin_from_wherever_it_is_read(tmp_path):
    path = camera(tmp_path)
    assert read_camera(path).intrinsics[:2, 2].tolist() == [20.0, 15.0]
    (tmp_path / "depth.npy").touch()
    assert read_camera(path).intrinsics[:2, 2].tolist() == [19.5, 14.5]
    path.write_text(json.dumps({"K": K, "note": "of another program"}))
    assert read_camera(path).intrinsics[:2, 2].tolist() == [320.0, 240.0]


def test_a_camera_may_state_the_origin_of_its_pixels(tmp_path):
    path = camera(tmp_path, first_pixel=0.5)
    assert read_camera(path).intrinsics[:2, 2].tolist() == [19.5, 14.5]
    (tmp_path / "depth.png").touch()
    assert read_camera(path).intrinsics[:2, 2].tolist() == [19.5, 14.5]
    camera(tmp_path, first_pixel=0)
    assert read_camera(path).intrinsics[:2, 2].tolist() == [20.0, 15.0]
    with pytest.raises(ValueError, match=r"first_pixel must be 0, or 0\.5"):
        read_camera(camera(tmp_path, first_pixel=320))


def test_a_camera_is_for_pictures_of_its_size_where_both_sides_are_said():
    assert PinholeCamera(fx=1, fy=1, cx=1, cy=1, width=4, height=3).size == (4, 3)
    assert PinholeCamera(fx=1, fy=1, cx=1, cy=1, width=4).size is None
    assert PinholeCamera(fx=1, fy=1, cx=1, cy=1).size is None


def test_a_camera_is_read_from_json(tmp_path):
    found = read_camera(camera(tmp_path, depth_scale=0.001, map_from_camera=POSE.tolist()))
    assert (found.fx, found.fy, found.cx, found.cy, found.depth_scale) == (50, 40, 19.5, 14.5, 0.001)
    assert pose_of(found.map_from_camera) == pytest.approx(POSE)


@pytest.mark.parametrize(
    "numbers", [{"fx": 0}, {"fy": -1}, {"depth_scale": 0}, {"fx": "wide"}, {"focal": 3}], ids=str
)
def test_an_impossible_camera_is_told(tmp_path, numbers):
    with pytest.raises(ValueError, match="invalid intrinsics"):
        read_camera(camera(tmp_path, **numbers))


def test_a_pose_is_sixteen_numbers_or_four_rows():
    assert pose_of(tuple(POSE.ravel())) == pytest.approx(POSE)
    assert pose_of(tuple(POSE.tolist())) == pytest.approx(POSE)
    assert pose_of(None) is None
    for wrong in ((1.0,) * 15, (1.0,) * 16, ("a",) * 16, ([1.0], [1.0, 2.0]), tuple((2 * POSE).ravel())):
        with pytest.raises(ValueError, match="not a 4 x 4 pose matrix"):
            pose_of(wrong)
