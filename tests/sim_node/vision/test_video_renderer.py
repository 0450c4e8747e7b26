"""Images are rendered on a separate thread, from copies."""

import threading

import numpy as np
import pytest

from semmap.nodes.sim_node.config import CameraConfig
from semmap.nodes.sim_node.vision.video_renderer import SceneSnapshot, VideoRenderer, segment_bodies
from semmap.nodes.sim_node.vision.view import overview
from semmap.nodes.sim_node.world import World
from tests.sim_node.orders import order, pose

RAYS = {"graphics": False, "width": 16, "height": 12}


@pytest.fixture(scope="module")
def snapshot():
    world = World()
    world.spawn([order("box1", "", pose(0, 0), size_m=(2.0, 2.0, 0.5))])
    world.step(0.5)
    return SceneSnapshot(*world.snapshot(), stamp_ns=7)


@pytest.fixture
def renderer(request):
    renderers = []

    def make(*, wanted=True, **config):
        renderers.append(VideoRenderer(CameraConfig(**RAYS | config), lambda: wanted))
        return renderers[-1]

    yield make
    for renderer in renderers:
        renderer.close()


def test_segments_are_numbers_of_bodies_by_name():
    geoms = np.array([[0, 1], [2, -1]], dtype=np.int32)
    names, numbers = segment_bodies(geoms, ["table", "", "cup"])
    assert names == ("cup", "table")
    assert numbers.tolist() == [[2, 0], [1, 0]]
    assert numbers.dtype == np.uint16


def test_a_camera_gives_rgb_depth_and_segments_of_one_moment(renderer, snapshot):
    planes = renderer(segments=True).planes(snapshot, "overview")
    assert [frame.encoding for frame, _ in planes] == ["rgb8", "depth32f", "segments16"]
    assert [plane.shape for _, plane in planes] == [(12, 16, 3), (12, 16), (12, 16)]
    for frame, _ in planes:
        assert (frame.camera, frame.width, frame.height, frame.stamp_ns) == ("overview", 16, 12, 7)
        assert frame.sim_time_s == pytest.approx(0.5)
        assert frame.intrinsics[2] == 8.0
        assert frame.intrinsics[5] == 6.0
        assert frame.map_from_camera[15] == 1.0
    assert planes[0][0].names == ()
    assert planes[2][0].names == ("box1",)
    assert set(np.unique(planes[2][1])) == {0, 1}


@pytest.mark.parametrize("how", [{"segments": False}, {"segments": True, "wanted": False}])
def test_segments_are_not_made_unless_they_are_asked_for_and_wanted(renderer, snapshot, how):
    planes = renderer(**how).planes(snapshot, "overview")
    assert [frame.encoding for frame, _ in planes] == ["rgb8", "depth32f"]


def test_depth_has_noise_if_that_is_asked_for(renderer, snapshot):
    (_, exact) = renderer().planes(snapshot, "overview")[1]
    (_, again) = renderer().planes(snapshot, "overview")[1]
    (_, noisy) = renderer(noise=True).planes(snapshot, "overview")[1]
    assert (exact == again).all()
    assert (exact != noisy).any()


def test_a_film_has_the_planes_of_all_cameras(renderer, snapshot):
    published, done = [], threading.Event()

    def publish(plane):
        published.append(plane[0].encoding)
        if len(published) == 2:
            done.set()

    renderer().render_cameras(lambda: snapshot, publish)
    assert done.wait(60.0)
    assert published == ["rgb8", "depth32f"]


def test_no_frame_is_begun_while_the_last_is_being_made_and_then_the_next_one_is(renderer, snapshot):
    begun, go_on = [], threading.Event()
    one = renderer()

    def publish(plane):
        assert go_on.wait(60.0)

    def moment():
        begun.append(1)
        return snapshot

    one.render_cameras(moment, publish)
    one.render_cameras(moment, publish)
    assert len(begun) == 1
    go_on.set()
    one._rendering.result(60.0)
    one.render_cameras(moment, publish)
    assert len(begun) == 2


def test_what_failed_of_one_frame_is_told_with_the_next(renderer, snapshot):
    def publish(plane):
        raise RuntimeError("no subscriber")

    one = renderer()
    one.render_cameras(lambda: snapshot, publish)
    assert isinstance(one._rendering.exception(60.0), RuntimeError)
    with pytest.raises(RuntimeError, match="no subscriber"):
        one.render_cameras(lambda: snapshot, publish)


def test_a_picture_for_people_is_a_png(renderer, snapshot):
    view = overview(np.array([-1.0, -1.0, 0.0]), np.ones(3), 16, 12)
    plain = renderer().render_picture(snapshot, view).result(60.0).png
    assert plain.startswith(b"\x89PNG")
    labelled = renderer().render_picture(snapshot, view, {"box1": np.array([0.0, 0.0, 0.5])}).result(60.0).png
    assert labelled != plain


def test_a_still_is_stamped_when_it_is_taken(snapshot):
    now = SceneSnapshot(snapshot.model, snapshot.data, snapshot.names)
    assert now.stamp_ns > 1_600_000_000_000_000_000
