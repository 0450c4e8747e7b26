"""Images of depth and colour."""

import numpy as np
import pytest
from PIL import Image

from semmap.nodes.perception_node.input.files.camera_files import PinholeCamera
from semmap.nodes.perception_node.input.files.image_files import read_pictures

WIDTH, HEIGHT = 40, 30
CAMERA = PinholeCamera(fx=50.0, fy=40.0, cx=19.5, cy=14.5)
POSE = np.array([[0.0, -1, 0, 1], [1, 0, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]])


def depth(folder, numbers=1500, dtype=np.uint16, name="depth.png"):
    path = folder / name
    Image.fromarray(np.broadcast_to(np.asarray(numbers, dtype), (HEIGHT, WIDTH)).copy()).save(path)
    return path


def color(folder, size=(WIDTH, HEIGHT)):
    path = folder / "rgb.png"
    Image.new("RGB", size, (10, 20, 30)).save(path)
    return path


def test_a_pixel_s_middle_is_half_a_pixel_from_its_corner(tmp_path):
    cloud = read_pictures(depth(tmp_path), None, CAMERA)
    assert cloud.points_camera.shape == (HEIGHT, WIDTH, 3)
    assert cloud.points_camera[..., 2] == pytest.approx(1.5)
    row, column = 20, 30
    expected = ((column - 19.5) / 50.0 * 1.5, (row - 14.5) / 40.0 * 1.5, 1.5)
    assert cloud.points_camera[row, column] == pytest.approx(expected, abs=1e-5)
    assert cloud.intrinsics == pytest.approx(np.array([[50.0, 0, 20.0], [0, 40.0, 15.0], [0, 0, 1]]))
    assert (cloud.colors, cloud.map_from_camera) == (None, None)


def test_colours_and_a_pose_come_with_it(tmp_path):
    placed = PinholeCamera(fx=50.0, fy=40.0, cx=19.5, cy=14.5, map_from_camera=tuple(POSE.ravel().tolist()))
    cloud = read_pictures(depth(tmp_path), color(tmp_path), placed)
    assert (cloud.colors == [10, 20, 30]).all()
    assert cloud.map_from_camera == pytest.approx(POSE)


def test_floats_are_metres_and_another_unit_may_be_said(tmp_path):
    floats = depth(tmp_path, 1.5, np.float32, "depth.tiff")
    assert read_pictures(floats, None, CAMERA).points_camera[..., 2] == pytest.approx(1.5)
    tenths = PinholeCamera(fx=50.0, fy=40.0, cx=19.5, cy=14.5, depth_scale=0.0001)
    assert read_pictures(depth(tmp_path, 15000), None, tenths).points_camera[..., 2] == pytest.approx(1.5)


def test_numbers_that_look_like_another_unit_are_told_with_what_to_say(tmp_path):
    with pytest.raises(ValueError, match=r'set "depth_scale": 0\.001 in the intrinsics'):
        read_pictures(depth(tmp_path, 1500.0, np.float32, "depth.tiff"), None, CAMERA)


def test_pictures_that_do_not_go_together_are_told(tmp_path):
    with pytest.raises(ValueError, match="colour is 20 x 10 pixels, depth 40 x 30"):
        read_pictures(depth(tmp_path), color(tmp_path, (20, 10)), CAMERA)
    other = PinholeCamera(fx=50.0, fy=40.0, cx=19.5, cy=14.5, width=80, height=60)
    with pytest.raises(ValueError, match="for images of 80 x 60; this one has 40 x 30 pixels"):
        read_pictures(depth(tmp_path), None, other)
    crop = PinholeCamera(fx=50.0, fy=40.0, cx=1.5, cy=14.5)
    (note,) = read_pictures(depth(tmp_path), None, crop).notes
    assert "cx 1.5 cy 14.5" in note
    wrong = PinholeCamera(fx=50.0, fy=40.0, cx=1900.5, cy=14.5)
    with pytest.raises(ValueError, match=r"fx 50 fy 40 cx 1900\.5 cy 14\.5 do not fit an image of 40 x 30"):
        read_pictures(depth(tmp_path), None, wrong)
