import io

import numpy as np
import pytest
from PIL import Image

from semmap.nodes.sim_node.vision.camera import Eye, picture_png
from semmap.nodes.sim_node.vision.offscreen import open_gl
from semmap.nodes.sim_node.vision.view import camera_view, look_at, overview
from semmap.nodes.sim_node.world import World
from semmap.schemas.errors import BadRequest
from tests.sim_node.orders import order, pose


@pytest.fixture(scope="module")
def world():
    world = World()
    world.spawn(
        [
            order("box1", "", pose(0, 0), size_m=(0.4, 0.6, 0.5)),
            order("chair1", "chair", pose(1.0, 0.5, yaw=0.4)),
        ]
    )
    world.step(0.5)
    return world


def above(width=80, height=60):
    """Return a camera 3 m above the box's centre, looking down with the map's y up in the image."""
    return look_at(np.array([0.0, -1e-6, 3.0]), np.zeros(3), width, height, np.radians(60))


@pytest.fixture(scope="module", params=["rays", "graphics"])
def eye(request):
    eye = Eye(graphics=request.param == "graphics")
    if request.param == "graphics" and not eye.has_graphics:
        pytest.skip("no OpenGL is to be had here")
    return eye


def test_depth_is_metres_along_the_optical_axis(world, eye):
    rgb, depth = eye.render(world.model, world.data, above())
    assert rgb.shape == (60, 80, 3)
    assert rgb.dtype == np.uint8
    assert depth.dtype == np.float32
    assert depth[30, 40] == pytest.approx(2.5, abs=0.002)  # the top of the box
    assert depth[2, 2] == pytest.approx(3.0, abs=0.003)  # the floor, in a corner of the picture


def test_points_land_in_the_map_frame(world, eye):
    view = camera_view(world.model, world.data, "overview", 160, 120)
    _, depth = eye.render(world.model, world.data, view)
    v, u = np.nonzero(depth)
    rays = np.linalg.inv(view.intrinsics) @ np.stack([u + 0.5, v + 0.5, np.ones_like(u)])
    camera = np.concatenate([rays * depth[v, u], np.ones((1, len(u)))])
    points = (view.map_from_camera @ camera)[:3].T
    floor = points[:, 2] < 0.01
    assert floor.mean() > 0.5
    assert np.abs(points[floor, 2]).max() < 0.01
    assert points[:, 2].max() == pytest.approx(0.9, abs=0.05)  # the chair's back


def test_each_pixel_says_whose_it_is(world, eye):
    geoms = eye.segment(world.model, world.data, above())
    names = np.array([*world.body_names(), "nothing"])[geoms]
    assert names[30, 40] == "box1"
    assert names[2, 2] == ""
    assert set(names.ravel()) <= {"", "box1", "chair1", "nothing"}


def test_an_eye_that_is_gone_leaves_the_others_their_sight(world):
    if open_gl() is None:
        pytest.skip("no OpenGL is to be had here")
    tableware = World()
    tableware.spawn([order("bowl1", "bowl", pose(0, 0)), order("vase1", "vase", pose(0.5, 0))])

    def seen(eye):
        return [eye.render(w.model, w.data, above())[1].sum() for w in (world, tableware, world)]

    first, second = Eye(), Eye()
    before = seen(first)
    assert seen(second) == before
    assert seen(first) == before  # they do not mind to be used in turn
    assert seen(second) == before
    del first
    assert seen(second) == before


def test_both_ways_of_seeing_agree(world):
    if open_gl() is None:
        pytest.skip("no OpenGL is to be had here")
    view = above(160, 120)
    _, with_gl = Eye().render(world.model, world.data, view)
    _, with_rays = Eye(graphics=False).render(world.model, world.data, view)
    apart = np.abs(with_gl - with_rays)
    assert np.median(apart) < 0.0005
    assert np.mean(apart > 0.01) < 0.02  # silhouettes


def test_a_frame_follows_spawns(world, eye):
    before = eye.frame(world.model, world.data, "overview", 64, 48)
    world.spawn([order("wall9", "", pose(2.0, -2.0), size_m=(0.2, 3.0, 2.0))])
    after = eye.frame(world.model, world.data, "overview", 64, 48)
    world.delete(["wall9"])
    assert (before.map_from_camera == after.map_from_camera).all()
    assert (before.depth_m != after.depth_m).mean() > 0.01
    assert before.intrinsics[0, 2] == 32


def test_an_unknown_camera_is_told_with_those_there_are(world, eye):
    with pytest.raises(BadRequest, match="overview"):
        eye.frame(world.model, world.data, "kitchen", 64, 48)


def test_the_overview_holds_everything():
    low, high = np.array([0.0, -2.0, 0.0]), np.array([6.0, 3.0, 2.0])
    view = overview(low, high, 90, 60)
    corners = np.stack(np.meshgrid(*zip(low, high, strict=True)), axis=-1).reshape(-1, 3)
    in_camera = (corners - view.map_from_camera[:3, 3]) @ view.map_from_camera[:3, :3]
    pixels = in_camera @ view.intrinsics.T
    pixels = pixels[:, :2] / pixels[:, 2:]
    assert (in_camera[:, 2] > 0).all()
    assert (pixels > 0).all()
    assert (pixels < [90, 60]).all()


@pytest.mark.parametrize("graphics", [True, False])
def test_a_picture_shows_something(world, graphics):
    view = overview(*world.extent(), 96, 64)
    image = Image.open(io.BytesIO(picture_png(Eye(graphics=graphics), world.model, world.data, view)))
    assert image.size == (96, 64)
    assert np.asarray(image.convert("L")).std() > 5.0
