"""Agreement of a model and observed points: a ball of known points before a flat camera."""

import math

import numpy as np
import pytest

from semmap.nodes.perception_node.fitting.evidence import spacing_m, verified_share, visible_share
from semmap.nodes.perception_node.fitting.model_surfaces import ModelSurface
from semmap.nodes.perception_node.input.cloud import Cloud

WITHIN_M = 0.01


def plate(normal=(0.0, 0.0, -1.0), side=0.4, depth=0.0):
    """Return a square of points, (N, 3) in its own frame, with parallel normals."""
    line = np.linspace(-side / 2, side / 2, 41)
    x, y = np.meshgrid(line, line)
    points = np.stack([x.ravel(), y.ravel(), np.full(x.size, depth)], axis=1)
    return ModelSurface(points, np.tile(normal, (x.size, 1)).astype(float), np.array([side, side, 0.01]))


def at(x=0.0, y=0.0, z=1.0, turn=None):
    pose = np.eye(4)
    pose[:3, 3] = (x, y, z)
    if turn is not None:
        pose[:3, :3] = turn
    return pose


def seen(depth_m, *, height=120, width=160, pose=None):
    """Return a camera at the origin that sees a wall at this depth, or an array of depths."""
    depth = np.broadcast_to(np.asarray(depth_m, float), (height, width))
    intrinsics = np.array([[200.0, 0, width / 2], [0, 200.0, height / 2], [0, 0, 1]])
    u, v = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
    rays = np.stack([(u - width / 2) / 200.0, (v - height / 2) / 200.0, np.ones_like(u)], axis=-1)
    return Cloud((rays * depth[..., None]).astype(np.float32), None, pose, intrinsics)


def through(*clouds, model=None, pose=None):
    return visible_share(model or plate(), at() if pose is None else pose, clouds, WITHIN_M)


def test_points_are_as_far_apart_as_the_box_s_sides_share_out():
    model = plate()
    assert spacing_m(model) == pytest.approx(math.sqrt(2 * (0.16 + 2 * 0.004) / 1681))


@pytest.mark.parametrize(
    ("off_m", "share"), [(0.0, 1.0), (0.01, math.exp(-1)), (-0.01, math.exp(-1)), (0.1, 0.0)]
)
def test_what_lies_on_the_surface_bears_it_out_and_less_so_beside_it(off_m, share):
    own = plate()
    points = own.points + np.array([0.5, 0.2, 1.0 + off_m])
    assert verified_share(points, own, at(0.5, 0.2), WITHIN_M) == pytest.approx(share, abs=1e-3)


def test_between_the_points_of_a_surface_is_on_it_and_beyond_its_edge_is_not():
    own = plate()
    between = own.points[:1] + np.array([0.005, 0.005, 1.0])
    assert verified_share(between, own, at(), WITHIN_M) == pytest.approx(1.0)
    beyond = np.array([[0.2 + 0.02 + spacing_m(own), 0.0, 1.0]])
    assert verified_share(beyond, own, at(), WITHIN_M) == pytest.approx(math.exp(-4.0), abs=0.01)
    above = np.array([[0.2 + 0.006 + spacing_m(own), 0.0, 1.008]])
    assert verified_share(above, own, at(), WITHIN_M) == pytest.approx(math.exp(-1.0))


def test_the_pose_turns_the_model():
    quarter = np.array([[1.0, 0, 0], [0, 0, -1.0], [0, 1.0, 0]])
    own = plate()
    points = own.points @ quarter.T + (0.0, 0.3, 1.0)
    assert verified_share(points, own, at(0, 0.3, 1.0, quarter), WITHIN_M) == pytest.approx(1.0)
    assert verified_share(points, own, at(0, 0.3, 1.0), WITHIN_M) < 0.3


@pytest.mark.parametrize(
    ("depth_m", "share"),
    [(1.0, 1.0), (2.0, 0.0), (0.5, None), (1.005, 0.78), (0.99, 1.0), (1.01, 0.37)],
    ids=["there", "far behind", "hidden", "nearly", "a little nearer", "a little behind"],
)
def test_where_something_is_behind_the_surface_it_was_seen_through(depth_m, share):
    found = through(seen(depth_m))
    assert found == (None if share is None else pytest.approx(share, abs=0.01))


def test_what_was_seen_of_half_of_it_is_half():
    depth = np.ones((120, 160))
    depth[:, 80:] = 3.0
    assert through(seen(depth)) == pytest.approx(0.5, abs=0.03)


def test_where_nothing_was_measured_nothing_is_told():
    depth = np.ones((120, 160))
    depth[:, 80:] = np.nan
    assert through(seen(depth)) == pytest.approx(1.0)
    assert through(seen(np.nan)) is None


def test_a_surface_that_faces_away_or_is_seen_too_flatly_tells_nothing():
    assert through(seen(3.0), model=plate((0.0, 0.0, 1.0))) is None
    steep = (math.cos(math.asin(0.2)), 0.0, -0.2)
    assert through(seen(3.0), model=plate(steep, side=0.02)) is None
    flat = (math.cos(math.asin(0.3)), 0.0, -0.3)
    assert through(seen(3.0), model=plate(flat, side=0.02)) == pytest.approx(0.0)


def test_a_surface_behind_the_camera_or_beside_its_picture_tells_nothing():
    assert through(seen(3.0), pose=at(z=-1.0)) is None
    assert through(seen(3.0), pose=at(x=5.0, z=1.0)) is None
    assert through(seen(3.0), pose=at(y=-5.0, z=1.0)) is None
    assert through(seen(0.04), pose=at(z=0.04), model=plate(side=0.001)) is None


def test_what_the_model_itself_hides_tells_nothing():
    front, back = plate(side=0.6), plate(side=0.2, depth=0.5)
    both = ModelSurface(
        np.concatenate([front.points, back.points]),
        np.concatenate([front.normals, back.normals]),
        np.array([0.6, 0.6, 0.5]),
    )
    assert through(seen(1.0), model=both) == pytest.approx(1.0)


def test_several_cameras_add_up_and_those_without_a_picture_tell_nothing():
    good, bad = seen(1.0), seen(3.0)
    assert through(good, bad) == pytest.approx(0.5, abs=0.02)
    loose = Cloud(bad.points_camera.reshape(1, -1, 3), None, None, bad.intrinsics)
    unknown = Cloud(bad.points_camera)
    assert through(good, loose, unknown) == pytest.approx(1.0)
    assert through() is None


def test_a_camera_elsewhere_sees_from_there():
    pose = np.eye(4)
    pose[:3, 3] = (2.0, 1.0, -1.0)
    moved = at(2.0, 1.0, 0.0)
    assert through(seen(1.0, pose=pose), pose=moved) == pytest.approx(1.0)
    assert through(seen(2.0, pose=pose), pose=moved) == pytest.approx(0.0)
    turn = np.array([[0.0, 0, 1.0], [0, 1.0, 0], [-1.0, 0, 0]])  # it looks along the map's x axis
    sideways = np.eye(4)
    sideways[:3, :3] = turn
    assert through(seen(1.0, pose=sideways), pose=at(1.0, 0, 0, turn)) == pytest.approx(1.0)
