import io

import numpy as np
import pytest
from PIL import Image

from semmap.nodes.drawing.palette import colour_of
from semmap.nodes.recorder.drawing import perception_archetypes as archetypes
from semmap.nodes.recorder.recording import open_recording
from semmap.schemas.entities import Pose
from semmap.schemas.perception import Observation, Observations, SegmentedCloud
from semmap.schemas.scenes import CameraFrame
from tests.recorder.files import column
from tests.recorder.messages import START_NS

CUP = Observation(
    class_="Cup",
    probability=0.934,
    pose=Pose(position_m=(1.0, 2.0, 0.75), orientation_wxyz=(0.6, 0.0, 0.0, 0.8)),
    size_m=(0.08, 0.1, 0.12),
    points=900,
    entity="cup1",
)
SEEN = Observations(stamp_ns=START_NS, views=(), observations=(CUP,))
FRAME = CameraFrame(
    camera="left",
    encoding="rgb8",
    width=640,
    height=480,
    stamp_ns=START_NS,
    sim_time_s=1.0,
    intrinsics=(500.0, 0.0, 320.0, 0.0, 500.0, 240.0, 0.0, 0.0, 1.0),
    map_from_camera=(1.0, 0.0, 0.0, 3.0, 0.0, 1.0, 0.0, 4.0, 0.0, 0.0, 1.0, 5.0, 0.0, 0.0, 0.0, 1.0),
)


def recorded(tmp_path, path, *archetypes):
    file = tmp_path / "a.rrd"
    with open_recording(file, None) as recording:
        recording.set_time(1, START_NS, None)
        recording.show(path, *archetypes)
    return lambda component: column(file, f"/{path}", component)


def test_a_look_comes_back_with_boxes_class_and_probability(tmp_path):
    read = recorded(tmp_path, archetypes.BOXES, *archetypes.boxes_of(SEEN))
    assert read("Boxes3D:half_sizes") == [pytest.approx((0.04, 0.05, 0.06))]
    assert read("Boxes3D:centers") == [pytest.approx((1.0, 2.0, 0.81))]
    assert read("Boxes3D:quaternions") == [pytest.approx((0.0, 0.0, 0.8, 0.6))]
    assert read("Boxes3D:labels") == ["cup1: Cup 93%"]
    assert read(f"{archetypes.OBSERVATION_FIELDS}:class") == ["Cup"]
    assert read(f"{archetypes.OBSERVATION_FIELDS}:probability") == [pytest.approx(0.934)]
    assert read(f"{archetypes.OBSERVATION_FIELDS}:entity") == ["cup1"]


def test_a_look_that_shows_nothing_leaves_no_box(tmp_path):
    nothing = Observations(stamp_ns=START_NS, views=(), observations=())
    read = recorded(tmp_path, archetypes.BOXES, *archetypes.boxes_of(nothing))
    assert read("Boxes3D:half_sizes") == []


def test_points_of_things_have_the_colours_of_their_classes():
    positions = np.arange(9, dtype="<f4")
    cloud = SegmentedCloud(
        stamp_ns=START_NS,
        positions=positions.tobytes(),
        colors=bytes([9] * 9),
        labels=np.array([0, 1, 7], "<u2").tobytes(),
    )
    points = archetypes.points_of(cloud, SEEN)
    packed = points.colors.as_arrow_array().to_pylist()
    red, green, blue = colour_of("Cup")
    assert packed == [0x090909FF, red << 24 | green << 16 | blue << 8 | 0xFF, 0x090909FF]


def test_a_picture_is_recorded_small_with_its_camera(tmp_path):
    pixels = np.zeros((480, 640, 3), np.uint8)
    pixels[:, 320:] = (200, 100, 50)
    read = recorded(tmp_path, archetypes.camera_path("left"), *archetypes.image_of(FRAME, pixels.tobytes()))
    assert read("Transform3D:translation") == [(3.0, 4.0, 5.0)] or read("Transform3D:translation") == [
        [3, 4, 5]
    ]
    (resolution,) = read("Pinhole:resolution")
    assert tuple(resolution) == (320, 240)
    (blob,) = read("EncodedImage:blob")
    picture = Image.open(io.BytesIO(bytes(blob)))
    assert picture.size == (320, 240)
    assert picture.getpixel((240, 120)) == pytest.approx((200, 100, 50), abs=6)


def test_pixels_that_are_not_the_frames_are_refused():
    with pytest.raises(ValueError, match="not enough"):
        archetypes.image_of(FRAME, b"too few")


@pytest.mark.parametrize(
    ("positions", "colors", "labels"), [(12, 3, 4), (24, 3, 2), (13, 3, 2), (12, 6, 2), (0, 3, 2)]
)
def test_a_cloud_of_wrong_sizes_is_invalid(positions, colors, labels):
    cloud = SegmentedCloud(
        stamp_ns=START_NS, positions=bytes(positions), colors=bytes(colors), labels=bytes(labels)
    )
    with pytest.raises(ValueError, match="same number of points"):
        archetypes.points_of(cloud, SEEN)
