"""Frames of a depth camera of one's own."""

import numpy as np
import pytest

from semmap.nodes.extern.camera_planes import make_planes
from semmap.schemas.errors import BadRequest

RGB = np.arange(2 * 3 * 3, dtype=np.uint8).reshape(2, 3, 3)
DEPTH_M = np.array([[1.0, 2.0, np.nan], [0.0, -1.0, np.inf]])
LENS = (500.0, 510.0, 1.5, 1.0)
POSE = np.eye(4)


def planes(**changed):
    fields = {"name": "mine", "rgb": RGB, "depth_m": DEPTH_M, "intrinsics": LENS, "map_from_camera": POSE}
    return make_planes(**{**fields, **changed}, stamp_ns=7)


def test_both_planes_describe_the_same_frame():
    (colour, rgb, first), (depth, _, second) = planes()
    assert (colour, depth, first.encoding, second.encoding) == ("rgb", "depth", "rgb8", "depth32f")
    assert rgb == bytes(range(18))
    assert (first.width, first.height, first.stamp_ns) == (3, 2, 7)
    assert first.intrinsics == second.intrinsics == (500.0, 0.0, 1.5, 0.0, 510.0, 1.0, 0.0, 0.0, 1.0)
    assert first.map_from_camera == tuple(POSE.ravel())


def test_what_is_not_measured_has_depth_zero():
    _, (_, pixels, _) = planes()
    assert np.frombuffer(pixels, "<f4").tolist() == [1.0, 2.0, 0.0, 0.0, 0.0, 0.0]


def test_images_that_are_views_of_others_are_sent_row_by_row():
    (_, rgb, _), _ = planes(rgb=RGB[:, ::-1], depth_m=DEPTH_M.astype("f4"))
    assert rgb == RGB[:, ::-1].tobytes()


@pytest.mark.parametrize(
    ("changed", "reason"),
    [
        ({"name": "a/b"}, "'a/b' is not a valid camera name"),
        ({"rgb": RGB[..., 0]}, r"rgb is \(2, 3\) of uint8; it must be \(height, width, 3\) of 8-bit numbers"),
        ({"rgb": RGB / 255.0}, r"rgb is \(2, 3, 3\) of float64"),
        ({"rgb": "image.png"}, "rgb is not an array of numbers"),
        (
            {"depth_m": np.full((2, 3), 1500)},
            r"\(2, 3\) of floats, in metres; convert millimetres",
        ),
        ({"depth_m": DEPTH_M.T}, r"depth_m is \(3, 2\) of float64"),
        ({"intrinsics": (500.0, 0.0, 1.5)}, r"intrinsics must be a \(3, 3\) matrix or \(fx, fy, cx, cy\)"),
        ({"intrinsics": np.zeros((3, 3))}, "with positive focal lengths"),
        ({"map_from_camera": np.eye(3)}, r"map_from_camera must be a \(4, 4\) matrix"),
        ({"map_from_camera": np.diag([1.0, 1.0, -1.0, 1.0])}, "has no valid rotation"),
        ({"map_from_camera": np.diag([2.0, 2.0, 2.0, 1.0])}, "has no valid rotation"),
    ],
)
def test_invalid_arrays_are_rejected(changed, reason):
    with pytest.raises(BadRequest, match=reason):
        planes(**changed)
