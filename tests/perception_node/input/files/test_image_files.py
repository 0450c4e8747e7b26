"""Images of depth and colour, and the camera file."""

import json

import numpy as np
import pytest
from PIL import Image

from semmap.nodes.perception_node.input.files.image_files import (
    PinholeCamera,
    is_depth,
    pose_of,
    read_camera,
    read_pictures,
)

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


def camera(folder, **numbers):
    path = folder / "camera.json"
    path.write_text(json.dumps({"fx": 50, "fy": 40, "cx": 19.5, "cy": 14.5} | numbers))
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
    wrong = PinholeCamera(fx=50.0, fy=40.0, cx=1900.5, cy=14.5)
    with pytest.raises(ValueError, match=r"fx 50 fy 40 cx 1900\.5 cy 14\.5 do not fit an image of 40 x 30"):
        read_pictures(depth(tmp_path), None, wrong)


def test_a_camera_is_for_pictures_of_its_size_where_both_sides_are_said():
    assert PinholeCamera(fx=1, fy=1, cx=1, cy=1, width=4, height=3).size == (4, 3)
    assert PinholeCamera(fx=1, fy=1, cx=1, cy=1, width=4).size is None
    assert CAMERA.size is None


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


def test_depth_is_a_single_channel_of_16_bits_or_more(tmp_path):
    assert is_depth(depth(tmp_path))
    assert is_depth(depth(tmp_path, 1.5, np.float32, "depth.tiff"))
    assert not is_depth(color(tmp_path))
