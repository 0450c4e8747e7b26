import numpy as np
import pytest

from semmap.nodes.extern.ros.cameras import Camera, parse_camera
from semmap.nodes.extern.ros.frames import Frames
from semmap.schemas import errors
from tests.extern.ros.made import image, info, transforms

COLOUR = np.zeros((4, 6, 3), np.uint8)
DEPTH = np.full((4, 6), 1500, np.uint16)


@pytest.fixture
def camera():
    frames = Frames()
    frames.take(transforms(("lens", "map", (0, 0, 1))), static=True)
    made = Camera("front", frames, "map")
    made.take_info(info(6, 4))
    return made


def test_colour_and_depth_of_one_moment_are_a_frame(camera):
    assert camera.take_colour(image(COLOUR, "rgb8", stamp_ns=100)) is None
    found = camera.take_depth(image(DEPTH, "16UC1", stamp_ns=20_000_100))
    assert (found.colour.stamp_ns, found.depth.stamp_ns) == (20_000_100, 20_000_100)
    assert (found.colour.encoding, found.depth.encoding) == ("rgb8", "depth32f")
    assert found.depth.map_from_camera[11] == 1.0
    assert found.rgb == COLOUR.tobytes()
    assert np.frombuffer(found.depth_m, "<f4")[0] == 1.5


def test_in_ros_the_first_pixel_is_at_zero(camera):
    camera.take_colour(image(COLOUR, "rgb8"))
    found = camera.take_depth(image(DEPTH, "16UC1"))
    assert found.depth.intrinsics[2] == 3.5


def test_images_that_are_apart_in_time_are_not_a_frame(camera):
    camera.take_colour(image(COLOUR, "rgb8", stamp_ns=0))
    assert camera.take_depth(image(DEPTH, "16UC1", stamp_ns=50_000_000)) is None
    assert camera.take_colour(image(COLOUR, "rgb8", stamp_ns=60_000_000)) is not None


def test_without_intrinsics_there_is_no_frame():
    made = Camera("front", Frames(), "map")
    made.take_colour(image(COLOUR, "rgb8"))
    assert made.take_depth(image(DEPTH, "16UC1")) is None


def test_intrinsics_of_another_size_are_refused(camera):
    camera.take_info(info(12, 8))
    camera.take_colour(image(COLOUR, "rgb8"))
    with pytest.raises(
        errors.BadRequest, match="the intrinsics are for 12 x 8 pixels, the depth image has 6 x 4"
    ):
        camera.take_depth(image(DEPTH, "16UC1"))


def test_three_topics_make_a_camera():
    said = parse_camera("front=/a/color,/a/depth,/a/info")
    assert said == ("front", "/a/color", "/a/depth", "/a/info")


@pytest.mark.parametrize("said", ["front", "front=/a,/b", "=/a,/b,/c", "front=a,/b,/c", "front=/a,/b,/c d"])
def test_anything_else_is_none(said):
    with pytest.raises(errors.BadRequest, match="is not NAME=COLOUR,DEPTH,INFO; example: front="):
        parse_camera(said)
