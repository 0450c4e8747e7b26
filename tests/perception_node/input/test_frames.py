"""Synchronisation of frames, and the errors for invalid ones."""

from __future__ import annotations

import threading

import numpy as np
import pytest
from msgspec import structs

from semmap.nodes.perception_node.input import frames as module
from semmap.nodes.perception_node.input.frames import Frames, Pair, Plane, read_cloud, read_masks
from semmap.nodes.perception_node.input.projection import thinning
from semmap.schemas.errors import BadRequest
from semmap.schemas.perception import DetectedMasks, MaskImage, MaskRun
from semmap.schemas.scenes import CameraFrame

DEPTH = CameraFrame(
    camera="left",
    encoding="depth32f",
    width=64,
    height=48,
    stamp_ns=1_000,
    sim_time_s=0.0,
    intrinsics=(60.0, 0.0, 32.0, 0.0, 60.0, 24.0, 0.0, 0.0, 1.0),
    map_from_camera=(1.0, 0.0, 0.0, 3.0, 0.0, 1.0, 0.0, 4.0, 0.0, 0.0, 1.0, 5.0, 0.0, 0.0, 0.0, 1.0),
)
NAN = float("nan")


def pair(depth_m=1.0, rgb=None, **changes):
    depth = structs.replace(DEPTH, **changes)
    colour = structs.replace(depth, encoding="rgb8", **(rgb or {}))
    pixels = np.full((depth.height, depth.width), depth_m, "<f4").tobytes()
    return Pair(Plane(colour, lambda: bytes(colour.width * colour.height * 3)), Plane(depth, lambda: pixels))


def put(frames, camera, stamp_ns, *encodings):
    for encoding in encodings or ("rgb8", "depth32f"):
        frames.put(structs.replace(DEPTH, camera=camera, stamp_ns=stamp_ns, encoding=encoding), bytes)


def taken(frames, timeout_s=0.0):
    return [(p.depth.frame.camera, p.stamp_ns) for p in frames.take(timeout_s)]


def test_the_planes_of_one_moment_are_a_pair():
    frames = Frames()
    put(frames, "left", 1, "rgb8")
    assert taken(frames) == []
    put(frames, "left", 2, "depth32f")
    assert taken(frames) == []
    put(frames, "left", 2, "rgb8")
    assert taken(frames) == [("left", 2)]
    assert taken(frames) == []


def test_the_newest_is_taken_and_what_was_not_taken_in_time_is_gone():
    frames = Frames()
    for stamp_ns in range(1, 5):
        put(frames, "left", stamp_ns)
    assert taken(frames) == [("left", 4)]
    assert taken(frames) == []


def test_cameras_that_see_together_are_taken_together():
    frames = Frames()
    put(frames, "left", 1)
    assert taken(frames) == [("left", 1)]
    put(frames, "right", 1)
    put(frames, "left", 2)
    later = threading.Timer(0.05, lambda: put(frames, "right", 2))
    later.start()
    assert taken(frames) == [("left", 2), ("right", 2)]
    later.join()


def test_cameras_with_clocks_of_their_own_take_turns():
    frames = Frames()
    seen = []
    for moment in range(10, 100, 10):  # the right one is always a little newer
        put(frames, "left", moment)
        put(frames, "right", moment + 1)
        seen += taken(frames)
    assert [camera for camera, _ in seen] == ["right", "left"] * 4 + ["right"]
    assert [stamp_ns // 10 for _, stamp_ns in seen] == list(range(1, 10))


def test_a_frame_that_is_late_is_not_taken_after_a_newer_one():
    frames = Frames()
    put(frames, "left", 1)
    put(frames, "right", 1)
    assert taken(frames) == [("left", 1), ("right", 1)]
    put(frames, "right", 2)
    put(frames, "left", 3)
    put(frames, "right", 3)
    assert taken(frames) == [("left", 3), ("right", 3)]
    assert taken(frames) == []


def test_a_camera_that_has_fallen_silent_is_waited_for_only_once():
    frames = Frames()
    put(frames, "left", 1)
    put(frames, "right", 1)
    assert taken(frames) == [("left", 1), ("right", 1)]
    for stamp_ns in range(2, 12):  # ten waits would be too many
        put(frames, "left", stamp_ns)
        assert taken(frames) == [("left", stamp_ns)]
    put(frames, "left", 20)
    put(frames, "right", 5)  # it is back, and its clock is its own now
    assert [taken(frames), taken(frames)] == [[("right", 5)], [("left", 20)]]


def test_a_frame_of_the_past_is_refused():
    frames = Frames()
    put(frames, "left", 3_000_000_000)
    with pytest.raises(BadRequest, match="camera left: frame ignored: its stamp is not newer"):
        put(frames, "left", 1_000_000_000)
    put(frames, "right", 1_000_000_000)


def test_a_good_pair_is_a_cloud():
    cloud = read_cloud(pair(2.0))
    assert cloud.points_camera.shape == (48, 64, 3)
    assert cloud.points_camera[0, 0] == pytest.approx(((0.5 - 32) / 60 * 2, (0.5 - 24) / 60 * 2, 2.0))
    assert (cloud.camera, cloud.stamp_ns) == ("left", 1_000)
    assert cloud.map_from_camera[:3, 3].tolist() == [3.0, 4.0, 5.0]


def test_a_large_frame_is_thinned_and_its_points_stay_where_they_are():
    intrinsics = (3000.0, 0.0, 2000.0, 0.0, 3000.0, 1500.0, 0.0, 0.0, 1.0)
    large = pair(2.0, width=4000, height=3000, intrinsics=intrinsics)
    step = thinning(4000, 3000)
    cloud = read_cloud(large)
    assert step == 6
    assert cloud.points_camera.shape == (500, 667, 3)
    for row, column in ((0, 0), (100, 200), (499, 666)):
        x, y = (step * column + 0.5 - 2000) / 3000 * 2, (step * row + 0.5 - 1500) / 3000 * 2
        assert cloud.points_camera[row, column] == pytest.approx((x, y, 2.0), abs=1e-5)


def test_unusual_intrinsics_are_used_and_noted():
    assert read_cloud(pair()).notes == ()
    cropped = pair(intrinsics=(60.0, 0, -20.0, 0, 60.0, 24.0, 0, 0, 1))
    (note,) = read_cloud(cropped).notes
    assert "cx is probably about 32, cy about 24" in note


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        (
            {"rgb": {"width": 32}},
            r"its colour image has 32 x 48 pixels, its depth 64 x 48; they must have the same size",
        ),
        ({"intrinsics": (0.0,) * 9}, r"the intrinsics .* do not fit"),
        ({"intrinsics": (NAN,) * 9}, r"the intrinsics .* do not fit"),
        ({"intrinsics": (1.0, 2.0)}, r"the intrinsics have 2 numbers; the format is fx 0 cx 0"),
        ({"intrinsics": (60.0, 0, 900.0, 0, 60.0, 24.0, 0, 0, 1)}, r"the intrinsics .* do not fit"),
        ({"map_from_camera": (1.0,) * 16}, r"map_from_camera is not a 4 x 4 pose"),
        ({"map_from_camera": ()}, r"map_from_camera is not a 4 x 4 pose"),
        ({"width": 0}, r"do not fit an image of 0 x 48 pixels"),
    ],
)
def test_a_frame_that_makes_no_sense_is_told_in_one_sentence(changes, reason):
    with pytest.raises(BadRequest, match=f"^camera left: .*{reason}"):
        read_cloud(pair(**changes))


def test_too_few_bytes_are_no_picture():
    cut = pair()._replace(depth=Plane(DEPTH, lambda: b"1234"))
    with pytest.raises(
        BadRequest, match="4 bytes are not a depth32f image of 64 x 48 pixels, which has 12288"
    ):
        read_cloud(cut)


@pytest.mark.parametrize("depth_m", [0.0, NAN, np.inf])
def test_a_frame_that_shows_nothing_is_an_empty_cloud(depth_m):
    assert np.isnan(read_cloud(pair(depth_m)).points_camera[..., 2]).all()


def masks(camera, stamp_ns, **changes):
    found = DetectedMasks(camera=camera, stamp_ns=stamp_ns, width=64, height=48)
    return structs.replace(found, **changes)


def test_frames_of_a_camera_with_a_detector_wait_for_their_masks():
    frames = Frames()
    frames.put_masks(masks("left", 1))  # the first tells that there is a detector
    for stamp_ns in (2, 3, 4):
        put(frames, "left", stamp_ns)
    assert taken(frames) == []
    frames.put_masks(masks("left", 3))
    (pair,) = frames.take(0.0)
    assert (pair.stamp_ns, pair.masks.stamp_ns) == (3, 3)
    assert taken(frames) == []
    frames.put_masks(masks("left", 4))
    assert taken(frames) == [("left", 4)]


def test_other_cameras_do_not_wait():
    frames = Frames()
    frames.put_masks(masks("left", 1))
    put(frames, "right", 2)
    assert taken(frames) == [("right", 2)]


def test_masks_without_their_frame_are_refused():
    frames = Frames()
    frames.put_masks(masks("left", 1))
    put(frames, "left", 2)
    for stamp_ns in (1, 3):
        with pytest.raises(BadRequest, match="camera left: masks ignored: no frame with their stamp_ns"):
            frames.put_masks(masks("left", stamp_ns))


def test_a_detector_that_falls_silent_is_not_waited_for(monkeypatch):
    frames = Frames()
    frames.put_masks(masks("left", 1))
    monkeypatch.setattr(module, "_SILENT_S", 0.0)
    put(frames, "left", 2)
    assert taken(frames) == [("left", 2)]


def test_masks_are_as_fine_as_the_cloud():
    labels = np.zeros((3000, 4000), "<u2")
    labels[600:1200, 600:1200] = 1
    intrinsics = (3000.0, 0.0, 2000.0, 0.0, 3000.0, 1500.0, 0.0, 0.0, 1.0)
    image = MaskImage(labels=labels.tobytes(), names=("cup",))
    found = masks("left", 1_000, width=4000, height=3000, image=image, alone=True)
    read = read_masks(pair(2.0, width=4000, height=3000, intrinsics=intrinsics)._replace(masks=found))
    assert read.labels.shape == (500, 667)
    assert read.labels[100:200, 100:200].all()
    assert read.labels.sum() == 100 * 100
    assert read.alone


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"width": 32}, "of 32 x 48 pixels, the image of 64 x 48"),
        ({"masks": (MaskRun(size=(4, 4), counts=(16,)),)}, "a mask has 4 x 4 pixels"),
        ({"image": MaskImage(labels=b"abc")}, "not a label image of 64 x 48 pixels"),
    ],
)
def test_masks_that_do_not_fit_their_picture_are_told(wrong, said):
    with pytest.raises(BadRequest, match=f"camera left: masks ignored: .*{said}"):
        read_masks(pair()._replace(masks=masks("left", 1_000, **wrong)))
    assert read_masks(pair()) is None
