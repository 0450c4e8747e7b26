import numpy as np
import pytest

from nodes.perception_node.projection import cloud_of

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
