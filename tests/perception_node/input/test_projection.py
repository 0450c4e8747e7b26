import re

import numpy as np
import pytest

from semmap.nodes.perception_node.input.projection import (
    check_intrinsics,
    cloud_of,
    is_pose,
    thinned,
    thinning,
)

INTRINSICS = np.array([[100.0, 0.0, 2.0], [0.0, 100.0, 1.0], [0.0, 0.0, 1.0]])


def test_the_middle_of_a_pixel_is_where_its_ray_goes():
    cloud = cloud_of(np.full((2, 4), 2.0, np.float32), None, INTRINSICS)
    assert cloud.points_camera[0, 0] == pytest.approx([2.0 * -1.5 / 100, 2.0 * -0.5 / 100, 2.0])


def test_what_is_not_seen_is_nan():
    cloud = cloud_of(np.array([[0.0, np.nan, -1.0, 1.0]], np.float32), None, INTRINSICS)
    assert np.isnan(cloud.points_camera[0, :, 2]).tolist() == [True, True, True, False]


@pytest.mark.parametrize("bad", [np.eye(4), np.zeros((3, 3)), np.full((3, 3), np.nan)])
def test_wrong_intrinsics_are_told(bad):
    with pytest.raises(ValueError, match="intrinsics"):
        cloud_of(np.ones((2, 2), np.float32), None, bad)


def test_colours_of_another_size_are_told():
    with pytest.raises(ValueError, match="colours"):
        cloud_of(np.ones((2, 2), np.float32), np.zeros((3, 2, 3), np.uint8), INTRINSICS)


def pinhole(fx, fy, cx, cy):
    return np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])


@pytest.mark.parametrize(
    ("k", "width", "height", "doubt"),
    [
        pytest.param((525, 525, 320, 240), 640, 480, "", id="usual"),
        pytest.param((250, 250, 320, 240), 640, 480, "", id="wide"),
        pytest.param((1800, 1800, 320, 240), 640, 480, "", id="tele"),
        pytest.param((525, 525, 380, 190), 640, 480, "", id="a little off"),
        pytest.param(
            (100, 100, 320, 240), 640, 480, "view of 145 degrees.* fx and fy are probably about 576"
        ),
        pytest.param(
            (2000, 2000, 320, 240), 640, 480, "view of 18 degrees.* fx and fy are probably about 576"
        ),
        pytest.param((525, 525, 600, 70), 640, 480, "cx is probably about 320, cy about 240", id="crop"),
        pytest.param((525, 525, -200, 240), 320, 480, "cx is probably about 160, cy about 240", id="outside"),
        pytest.param((525, 525, 20, 20), 40, 40, "view of 4 degrees", id="a small crop"),
        pytest.param(
            (525, 525, 320, 240), 320, 240, r"from 640 x 480 pixels, fx is about 262\.5", id="half the size"
        ),
        pytest.param(
            (262.5, 262.5, 160, 120), 640, 480, "from 320 x 240 pixels, fx is about 525", id="twice"
        ),
    ],
)
def test_intrinsics_that_are_unusual_are_doubted_with_likely_values(k, width, height, doubt):
    found = check_intrinsics(pinhole(*k), width, height)
    assert re.search(doubt, found) if doubt else found == ""


@pytest.mark.parametrize(
    ("k", "reason"),
    [
        ((-525, 525, 320, 240), "do not fit .* not those of a pinhole"),
        ((525, 525, 320, np.nan), "do not fit .* not those of a pinhole"),
        ((525, 52.5, 320, 240), "fx and fy are too different; fx and fy are probably about 576"),
        ((50, 50, 320, 240), r"162\.2 degrees; fx and fy are probably about 576"),
        ((1e7, 1e7, 320, 240), r"0\.0 degrees; fx and fy are probably about 576"),
        ((525, 525, 5000, 240), "cx is probably about 320, cy about 240"),
    ],
)
def test_intrinsics_of_no_pinhole_camera_are_invalid(k, reason):
    with pytest.raises(ValueError, match=reason):
        check_intrinsics(pinhole(*k), 640, 480)


def test_intrinsics_are_three_by_three_without_skew():
    skewed = pinhole(525, 525, 320, 240)
    for wrong in (skewed.T, skewed + np.eye(3, k=1)):
        with pytest.raises(ValueError, match="without skew"):
            check_intrinsics(wrong, 640, 480)


def test_a_doubt_has_the_values_of_the_source():
    found = check_intrinsics(pinhole(525, 525, 600, 70), 640, 480, first_pixel=0.0)
    assert "cx 599.5 cy 69.5" in found
    assert "cx is probably about 319.5, cy about 239.5" in found


def test_a_pose_is_a_rotation_and_a_position():
    pose = np.eye(4)
    pose[:3, 3] = (1.0, 2.0, 3.0)
    assert is_pose(pose)
    for bad in (pose.T, 2 * pose, np.diag([1.0, 1.0, -1.0, 1.0]), np.zeros((4, 4)), np.full((4, 4), np.nan)):
        assert not is_pose(bad)


@pytest.mark.parametrize(
    ("k", "is_possible"),
    [
        ((64.0, 64.0, 320, 240), True),  # half the width is five focal lengths
        ((63.9, 63.9, 320, 240), False),
        ((64_000.0, 64_000.0, 320, 240), True),
        ((64_010.0, 64_010.0, 320, 240), False),
        ((525.0, 176.0, 320, 240), True),
        ((525.0, 175.0, 320, 240), False),
        ((176.0, 525.0, 320, 240), True),
        ((175.0, 525.0, 320, 240), False),
        ((200.0, 200.0, 1000, 240), True),
        ((200.0, 200.0, 1001, 240), False),
        ((200.0, 200.0, 320, -520), True),
        ((200.0, 200.0, 320, -521), False),
    ],
)
def test_a_pinhole_camera_has_limits(k, is_possible):
    if is_possible:
        check_intrinsics(pinhole(*k), 640, 480)
    else:
        with pytest.raises(ValueError, match="do not fit"):
            check_intrinsics(pinhole(*k), 640, 480)


@pytest.mark.parametrize(
    ("k", "is_usual"),
    [
        ((128.0, 128.0, 320, 240), True),  # a fifth of the longer side
        ((127.0, 127.0, 320, 240), False),
        ((1920.0, 1920.0, 320, 240), True),
        ((1921.0, 1921.0, 320, 240), False),
        ((525.0, 525.0, 448, 240), True),
        ((525.0, 525.0, 449, 240), False),
        ((525.0, 525.0, 320, 144), True),
        ((525.0, 525.0, 320, 143), False),
    ],
)
def test_a_usual_camera_has_narrower_ones(k, is_usual):
    assert (check_intrinsics(pinhole(*k), 640, 480) == "") == is_usual


@pytest.mark.parametrize(
    ("width", "height", "step"),
    [(640, 480, 1), (960, 480, 1), (961, 480, 2), (1920, 960, 2), (1921, 960, 3), (2, 2, 1)],
)
def test_a_large_image_is_thinned_until_it_has_few_pixels(width, height, step):
    assert thinning(width, height) == step


def test_a_thinned_image_has_the_rays_of_the_pixels_that_are_left():
    depth = np.arange(1, 26, dtype=np.float32).reshape(5, 5)
    rgb = np.arange(75, dtype=np.uint8).reshape(5, 5, 3)
    whole = cloud_of(depth, rgb, INTRINSICS)
    few = cloud_of(*thinned(depth, rgb, INTRINSICS, 2))
    assert few.points_camera == pytest.approx(whole.points_camera[::2, ::2], abs=1e-5)
    assert (few.colors == rgb[::2, ::2]).all()
    assert thinned(depth, rgb, INTRINSICS, 1)[0] is depth


def test_depth_is_valid_within_its_limits():
    depth = np.array([[0.01, 0.011, 99.9, 100.0]], np.float32)
    cloud = cloud_of(depth, None, INTRINSICS)
    assert np.isfinite(cloud.points_camera[0, :, 2]).tolist() == [False, True, True, False]
    assert (cloud.measured, cloud.organised) == (2, False)
