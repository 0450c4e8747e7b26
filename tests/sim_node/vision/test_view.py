"""Cameras: pose, view, and projection of points."""

import math

import mujoco
import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from semmap.nodes.sim_node.models.parts import rotation_matrix
from semmap.nodes.sim_node.vision.view import (
    View,
    bulk,
    camera_names,
    camera_view,
    look_at,
    optical_pose,
    overview,
    pinhole,
    pixel_rays,
)
from semmap.schemas.errors import BadRequest

FLOOR = """<mujoco><worldbody>
  <camera name="down" pos="1 2 3" fovy="60"/>
  <camera name="along" pos="0 0 1" xyaxes="0 -1 0 0 0 1" fovy="90"/>
</worldbody></mujoco>"""
PLACE = st.tuples(*[st.floats(-5.0, 5.0)] * 3).map(np.array)


@pytest.fixture(scope="module")
def scene():
    model = mujoco.MjModel.from_xml_string(FLOOR)
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    mujoco.mj_camlight(model, data)
    return model, data


def seen_at(view: View, point):
    """Return pixel (2,) and depth of a point of the map frame."""
    rotation, eye = view.map_from_camera[:3, :3], view.map_from_camera[:3, 3]
    x, y, z = rotation.T @ (np.asarray(point) - eye)
    u, v, w = view.intrinsics @ (x, y, z)
    return np.array([u / w, v / w]), z


def test_a_camera_of_the_world_sees_what_is_before_it_with_its_angle(scene):
    view = camera_view(*scene, "down", 80, 60)
    assert (view.width, view.height) == (80, 60)
    assert view.fovy_rad == pytest.approx(math.radians(60.0))
    pixel, depth = seen_at(view, (1.0, 2.0, 0.0))
    assert pixel == pytest.approx((40.0, 30.0))
    assert depth == pytest.approx(3.0)
    right, _ = seen_at(view, (2.0, 2.0, 0.0))
    up, _ = seen_at(view, (1.0, 3.0, 0.0))
    assert right[0] > 40.0
    assert up[1] < 30.0


def test_the_frame_of_a_camera_is_the_optical_one(scene):
    _, data = scene
    pose = optical_pose(data, 1)  # it looks along the map's x axis, z up in the picture
    assert pose.position_m == (0.0, 0.0, 1.0)
    right, down, ahead = rotation_matrix(pose.orientation_wxyz).T
    assert right == pytest.approx((0, -1, 0), abs=1e-9)
    assert down == pytest.approx((0, 0, -1), abs=1e-9)
    assert ahead == pytest.approx((1, 0, 0), abs=1e-9)


def test_cameras_are_named_and_an_unknown_one_is_told_with_them(scene):
    model, data = scene
    assert camera_names(model) == ("down", "along")
    with pytest.raises(BadRequest, match="unknown camera 'up'; the world has: down, along"):
        camera_view(model, data, "up", 80, 60)
    bare = mujoco.MjModel.from_xml_string("<mujoco/>")
    with pytest.raises(BadRequest, match="the world has: none"):
        camera_view(bare, mujoco.MjData(bare), "up", 80, 60)


@given(PLACE, PLACE)
def test_who_looks_at_a_point_has_it_in_the_middle_and_up_is_up(eye, target):
    assume(np.linalg.norm((target - eye)[:2]) > 0.1)
    view = look_at(eye, target, 80, 60, 1.0)
    rotation = view.map_from_camera[:3, :3]
    assert rotation @ rotation.T == pytest.approx(np.eye(3), abs=1e-9)
    assert np.linalg.det(rotation) == pytest.approx(1.0)
    pixel, depth = seen_at(view, target)
    assert pixel == pytest.approx((40.0, 30.0), abs=1e-6)
    assert depth == pytest.approx(np.linalg.norm(target - eye))
    above, _ = seen_at(view, target + np.array([0.0, 0.0, 0.01]))
    assert above[0] == pytest.approx(40.0, abs=1e-6)
    assert above[1] < 30.0


@pytest.mark.parametrize("height", [3.0, -3.0])
def test_who_looks_straight_up_or_down_has_the_map_s_x_axis_to_the_right(height):
    view = look_at(np.array([0.0, 0.0, height]), np.zeros(3), 80, 60, 1.0)
    right, _ = seen_at(view, (0.1, 0.0, 0.0))
    assert right[0] > 40.0
    assert right[1] == pytest.approx(30.0)


def test_pixels_are_square_and_the_angle_is_that_of_the_height():
    k = pinhole(80, 60, math.radians(90.0))
    assert k == pytest.approx(np.array([[30.0, 0.0, 40.0], [0.0, 30.0, 30.0], [0.0, 0.0, 1.0]]))
    assert View(80, 60, k, np.eye(4)).fovy_rad == pytest.approx(math.radians(90.0))


def test_a_ray_through_each_pixel_s_middle_comes_back_to_it():
    view = View(5, 3, np.array([[7.0, 0.0, 2.4], [0.0, 6.0, 1.3], [0.0, 0.0, 1.0]]), np.eye(4))
    rays = pixel_rays(view)
    assert rays.shape == (15, 3)
    u, v, w = view.intrinsics @ rays.T
    assert w == pytest.approx(1.0)
    assert u.reshape(3, 5) == pytest.approx(np.tile([0.5, 1.5, 2.5, 3.5, 4.5], (3, 1)))
    assert v.reshape(3, 5) == pytest.approx(np.tile([[0.5], [1.5], [2.5]], (1, 5)))


def test_the_bulk_of_bodies_is_the_box_around_all_but_those_far_off():
    low = np.array([(x, 0.0, 0.0) for x in (0.0, 1.0, 2.0, 3.0, 4.0, 500.0)])
    lowest, highest = bulk(low, low + 0.5)
    assert lowest == pytest.approx((0.0, 0.0, 0.0))
    assert highest == pytest.approx((4.5, 0.5, 0.5))
    lowest, highest = bulk(low[:5], low[:5] + 0.5)
    assert highest == pytest.approx((4.5, 0.5, 0.5))


@pytest.mark.parametrize(("away", "belongs"), [(10.9, True), (11.2, False)])
def test_far_off_is_four_times_as_far_as_most_and_three_metres_more(away, belongs):
    x = [0.0, 0.0, -2.0, 2.0, away]
    low = np.array([(one, 0.0, 0.0) for one in x])
    _, highest = bulk(low, low)
    assert highest[0] == pytest.approx(away if belongs else 2.0)


def test_without_bodies_the_bulk_is_two_metres_of_floor():
    lowest, highest = bulk(np.empty((0, 3)), np.empty((0, 3)))
    assert lowest.tolist() == [-1.0, -1.0, 0.0]
    assert highest.tolist() == [1.0, 1.0, 1.0]


@pytest.mark.parametrize(("width", "height"), [(90, 60), (60, 90)])
@pytest.mark.parametrize("box", [((0, -2, 0), (6, 3, 2)), ((-1, -1, 0), (1, 1, 5)), ((0, -9, 0), (1, 9, 1))])
def test_an_overview_just_holds_its_box(width, height, box):
    low, high = np.array(box, dtype=float)
    view = overview(low, high, width, height)
    corners = np.stack(np.meshgrid(*zip(low, high, strict=True)), axis=-1).reshape(-1, 3)
    pixels = np.array([seen_at(view, corner)[0] for corner in corners])
    assert (pixels >= 0.0).all()
    assert (pixels <= (width, height)).all()
    beyond = np.abs(pixels - (width / 2, height / 2)) / (width / 2, height / 2)
    assert beyond.max() > 0.9  # no farther off than it must be
    back = view.map_from_camera[:3, 3] - (low + high) / 2
    assert back / np.linalg.norm(back) == pytest.approx((0.396, -0.456, 0.793), abs=0.01)
    assert view.fovy_rad == pytest.approx(math.radians(36.0))
