import numpy as np
import pytest

from semmap.nodes.extern.ros.images import colour_of, depth_of
from semmap.schemas import errors
from tests.extern.ros.made import image

RED_BLUE = np.array([[[255, 0, 0], [0, 0, 255]]], np.uint8)


@pytest.mark.parametrize("padding", [0, 5])
@pytest.mark.parametrize(
    ("pixels", "encoding"),
    [
        (RED_BLUE, "rgb8"),
        (RED_BLUE[:, :, ::-1], "bgr8"),
        (np.dstack([RED_BLUE, np.full((1, 2), 9, np.uint8)]), "rgba8"),
        (np.dstack([RED_BLUE[:, :, ::-1], np.full((1, 2), 9, np.uint8)]), "bgra8"),
    ],
)
def test_colours_are_red_green_and_blue(pixels, encoding, padding):
    assert colour_of(image(pixels, encoding, padding=padding)) == RED_BLUE.tobytes()


def test_grey_is_all_three():
    assert colour_of(image(np.array([[7, 8]], np.uint8), "mono8")) == bytes([7, 7, 7, 8, 8, 8])


@pytest.mark.parametrize("padding", [0, 4])
def test_depth_is_in_metres(padding):
    millimetres = image(np.array([[1500, 0]], np.uint16), "16UC1", padding=padding)
    metres = image(np.array([[1.5, np.nan]], np.float32), "32FC1", padding=padding)
    for depth in (millimetres, metres):
        assert np.frombuffer(depth_of(depth), "<f4").tolist() == [1.5, 0.0]


def test_the_other_order_of_bytes_is_read():
    depth = image(np.array([[1500]], ">u2"), "16UC1")
    depth.is_bigendian = 1
    assert np.frombuffer(depth_of(depth), "<f4").tolist() == [1.5]


def test_what_cannot_be_read_is_reported_with_what_can():
    with pytest.raises(errors.BadRequest, match="'yuv422'; supported: rgb8, bgr8"):
        colour_of(image(RED_BLUE, "yuv422"))
    with pytest.raises(errors.BadRequest, match="'rgb8'; supported: 16UC1"):
        depth_of(image(RED_BLUE, "rgb8"))


def test_a_picture_that_is_cut_off_is_none():
    short = image(RED_BLUE, "rgb8")
    short.data = short.data[:4]
    with pytest.raises(errors.BadRequest, match="4 bytes are not an image of 2 x 1 pixels"):
        colour_of(short)
