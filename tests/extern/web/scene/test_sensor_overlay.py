"""Camera images and camera poses."""

import math

import numpy as np
import pytest

from semmap.nodes.extern.web.scene.picking import rotation_of
from semmap.nodes.extern.web.scene.sensor_overlay import camera_pose_of, image_of, wxyz_of
from semmap.schemas.entities import Pose
from semmap.schemas.scenes import CameraFrame


def frame(width=640, height=480, rotation=None):
    pose = np.eye(4)
    pose[:3, :3] = np.eye(3) if rotation is None else rotation
    pose[:3, 3] = (1.0, 2.0, 3.0)
    return CameraFrame(
        camera="hall",
        encoding="rgb8",
        width=width,
        height=height,
        stamp_ns=1,
        sim_time_s=0.0,
        intrinsics=(500.0, 0.0, width / 2, 0.0, 500.0, height / 2, 0.0, 0.0, 1.0),
        map_from_camera=tuple(pose.ravel().tolist()),
    )


def test_images_are_scaled_down():
    pixels = np.zeros((480, 640, 3), np.uint8)
    pixels[::2, ::2] = (10, 20, 30)
    picture = image_of(frame(), pixels.tobytes())
    assert picture.shape == (240, 320, 3)
    assert (picture == (10, 20, 30)).all()


def test_a_wrong_number_of_pixels_is_rejected():
    with pytest.raises(ValueError, match="reshape"):
        image_of(frame(), b"too few")


def test_the_camera_pose_is_that_of_the_frame():
    position, wxyz, fov_rad = camera_pose_of(frame())
    assert position == (1.0, 2.0, 3.0)
    assert wxyz == pytest.approx((1.0, 0.0, 0.0, 0.0))
    assert fov_rad == pytest.approx(2.0 * math.atan(240.0 / 500.0))


@pytest.mark.parametrize(
    "wxyz", [(1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1), (0.5, 0.5, -0.5, 0.5), (0.8, 0, 0.6, 0)]
)
def test_quaternions_match_their_rotation_matrix(wxyz):
    rotation = rotation_of(Pose(position_m=(0, 0, 0), orientation_wxyz=wxyz))
    found = np.array(wxyz_of(rotation))
    assert min(np.abs(found - wxyz).max(), np.abs(found + wxyz).max()) < 1e-9
