"""Point clouds in recordings."""

from __future__ import annotations

import bz2

import numpy as np
import pytest
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag1.reader import decompressors

from semmap.nodes.extern.frame_folders import bag
from semmap.nodes.extern.frame_folders.bag_clouds import columns_of, read_clouds
from semmap.nodes.extern.ros.types import new
from semmap.nodes.perception_node.input.viewpoint import Placement
from semmap.schemas.errors import BadFile, BadRequest
from tests.extern.frame_folders.recorded import ROS1, Said, as_ros1, seconds, write
from tests.extern.ros.made import image, stamped, transforms

RNG = np.random.default_rng(0)
FLOOR = np.concatenate([RNG.uniform([-1, -1, 0], [1, 1, 0], (900, 3)), RNG.uniform(0.1, 0.3, (100, 3))])
"""A floor with a thing above it, in the frame of a robot."""


def cloud(points, frame="base_link", *, at_s=0.0, topic="/points", **changed):
    """Return a `sensor_msgs/PointCloud2` of points (N, 3) with a colour and padding, on a topic."""
    row = np.zeros(
        len(points),
        {"names": ["x", "y", "z", "rgb"], "formats": ["<f4"] * 4, "offsets": [0, 4, 8, 16], "itemsize": 32},
    )
    for axis, values in zip("xyz", np.asarray(points).T, strict=True):
        row[axis] = values
    row["rgb"] = np.full(len(points), 0x102030, np.uint32).view(np.float32)
    fields = [
        new("sensor_msgs/msg/PointField", name=name, offset=offset, datatype=7, count=1)
        for name, offset in (("x", 0), ("y", 4), ("z", 8), ("rgb", 16))
    ]
    parts = {
        "header": stamped(frame, seconds(at_s)),
        "height": 1,
        "width": len(points),
        "fields": fields,
        "is_bigendian": False,
        "point_step": 32,
        "row_step": 32 * len(points),
        "data": row.view(np.uint8),
        "is_dense": True,
    }
    return Said(topic, seconds(at_s), new("sensor_msgs/msg/PointCloud2", **parts | changed))


def read(path, placement=None, topic=None, every_s=0.0):
    return [one for _, one in read_clouds(path, placement or Placement(), topic=topic, every_s=every_s)]


def in_map(found):
    pose = found.map_from_camera
    return found.points_camera.reshape(-1, 3) @ pose[:3, :3].T + pose[:3, 3]


@pytest.mark.parametrize("kind", ["bag", "db3", "mcap", "mcap1"])
def test_clouds_are_in_the_map_of_the_recording(tmp_path, kind):
    said = [
        Said("/tf", seconds(0), transforms(("base_link", "map", (5.0, 0.0, 0.5)), stamp_ns=seconds(0))),
        cloud(FLOOR),
    ]
    (found,) = read(write(tmp_path, kind, said))
    assert np.nanmedian(in_map(found), axis=0) == pytest.approx([5.0, 0.0, 0.5], abs=0.15)
    assert found.colors[0, 0].tolist() == [0x10, 0x20, 0x30]


def test_clouds_of_an_optical_frame_are_those_of_a_camera(tmp_path):
    ahead = FLOOR + np.array([0.0, 0.0, 2.0])
    (found,) = read(write(tmp_path, "mcap", [cloud(ahead, "lens_optical_frame")]))
    assert found.map_from_camera is None
    assert found.points_camera[0] == pytest.approx(ahead, abs=1e-5)


def test_some_of_the_clouds_are_read(tmp_path):
    said = [cloud(FLOOR + np.array([0.0, 0.0, 2.0]), at_s=0.5 * n) for n in range(5)]
    assert len(read(write(tmp_path, "mcap", said), every_s=1.0)) == 3


def test_clouds_without_points_are_skipped_unless_all_are(tmp_path):
    bad = [cloud(FLOOR[:0]), cloud(np.full((50, 3), np.nan), at_s=0.1)]
    good = cloud(FLOOR + np.array([0.0, 0.0, 2.0]), at_s=0.2)
    (found,) = read(write(tmp_path, "mcap", [*bad, good]), every_s=1.0)
    assert found.notes[-1].startswith("2 clouds before it skipped: ")
    assert found.notes[-1].endswith("0.000 s contains no points")
    (tmp_path / "bad").mkdir()
    with pytest.raises(BadFile, match="contains no points"):
        read(write(tmp_path / "bad", "mcap", bad))


def test_topics_of_clouds_are_listed(tmp_path):
    (tmp_path / "two").mkdir()
    two = write(tmp_path / "two", "mcap", [cloud(FLOOR), cloud(FLOOR, topic="/other")])
    with pytest.raises(
        BadRequest,
        match="/other and /points; choose one with --topic",
    ):
        read(two)
    with pytest.raises(BadRequest, match=r"no point clouds on /third"):
        read(two, topic="/third")
    assert read(two, topic="/other")
    none = write(tmp_path, "mcap", [Said("/image", seconds(0), image(np.zeros((4, 4), np.uint16), "16UC1"))])
    with pytest.raises(BadFile, match=r"has no point clouds .* semmap frames"):
        read(none)


@pytest.mark.parametrize(
    ("changed", "problem"),
    [
        ({"width": 100_000_000}, "do not fit its fields"),
        ({"point_step": 12, "row_step": 12_000}, "do not fit its fields"),
        ({"point_step": 0, "row_step": 0, "fields": []}, "do not fit its fields"),
        ({"data": np.zeros(100, np.uint8)}, "truncated: 100 of 32000 bytes"),
    ],
)
def test_a_cloud_that_does_not_fit_its_header_is_rejected(changed, problem):
    with pytest.raises(ValueError, match=problem):
        columns_of(cloud(FLOOR, **changed).message)


@pytest.mark.parametrize("kind", ["bz2", "lz4"])
def test_a_chunk_is_not_unpacked_beyond_the_limit(monkeypatch, kind):
    monkeypatch.setattr(bag, "_MOST_BYTES", 1000)
    pack = bz2.compress if kind == "bz2" else pytest.importorskip("lz4.frame").compress
    unpack = decompressors[kind]
    assert bag._unpack(unpack, pack(b"\0" * 999)) == b"\0" * 999
    with pytest.raises(ValueError, match="unpacks to more than"):
        bag._unpack(unpack, pack(b"\0" * 100_000))
    with pytest.raises(ValueError, match="truncated"):
        bag._unpack(unpack, pack(bytes(range(256)))[:-9])


@pytest.mark.parametrize("kind", ["mcap", "bz2"])
def test_a_recording_with_a_large_chunk_is_rejected_in_one_line(tmp_path, monkeypatch, kind):
    monkeypatch.setattr(bag, "_MOST_BYTES", 1000)
    file = write(tmp_path, "mcap", [cloud(FLOOR)]) if kind == "mcap" else compressed_bag(tmp_path / "a.bag")
    with pytest.raises(BadFile, match="a chunk unpacks to more than 512 MB"):
        read(file)


def compressed_bag(file):
    """Return a bag of ROS 1 with a cloud in a compressed chunk."""
    said = cloud(FLOOR + np.array([0.0, 0.0, 2.0]))
    writer = Writer1(file)
    writer.set_compression(Writer1.CompressionFormat.BZ2)
    with writer:
        kind = said.message.__msgtype__
        connection = writer.add_connection(said.topic, kind, typestore=ROS1)
        writer.write(connection, said.stamp_ns, ROS1.serialize_ros1(as_ros1(said.message), kind))
    return file


def test_a_compressed_bag_is_read(tmp_path):
    assert read(compressed_bag(tmp_path / "a.bag"))
