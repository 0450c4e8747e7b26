import numpy as np
import pytest

from semmap.nodes.perception_node.input.projection import cloud_of, fits, is_pose

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


@pytest.mark.parametrize(
    ("k", "width", "height", "fit"),
    [
        ((525.0, 525.0, 319.5, 239.5), 640, 480, True),
        ((525.0, 525.0, 319.5, 239.5), 1280, 960, False),
        ((525.0, 525.0, 319.5, 239.5), 320, 240, False),
        ((525.0, 525.0, 319.5, 239.5), 4000, 3000, False),
        ((262.5, 262.5, 160.0, 120.0), 640, 480, False),
        ((262.5, 262.5, 166.0, 115.0), 640, 480, False),
        ((525.0, 525.0, 380.0, 190.0), 640, 480, True),
        ((-525.0, 525.0, 319.5, 239.5), 640, 480, False),
        ((525.0, 0.5, 319.5, 239.5), 640, 480, False),
        ((525.0, 525.0, 319.5, np.nan), 640, 480, False),
        ((1e7, 1e7, 319.5, 239.5), 640, 480, False),
    ],
)
def test_the_intrinsics_of_another_picture_do_not_fit(k, width, height, fit):
    fx, fy, cx, cy = k
    intrinsics = np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])
    assert fits(intrinsics, width, height) is fit
    assert not fits(intrinsics.T, width, height)
    skewed = intrinsics.copy()
    skewed[0, 1] = 1.0
    assert not fits(skewed, width, height)


def test_a_pose_is_a_rotation_and_a_position():
    pose = np.eye(4)
    pose[:3, 3] = (1.0, 2.0, 3.0)
    assert is_pose(pose)
    for bad in (pose.T, 2 * pose, np.diag([1.0, 1.0, -1.0, 1.0]), np.zeros((4, 4)), np.full((4, 4), np.nan)):
        assert not is_pose(bad)
