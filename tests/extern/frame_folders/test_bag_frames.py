"""`semmap frames RECORDING DIR` on bags of ROS 1 and 2."""

from __future__ import annotations

import json
import struct

import numpy as np
import pytest
from mcap.reader import SeekingReader
from mcap.writer import Writer as McapWriter
from PIL import Image

from semmap.nodes.extern.cli.app import execute
from semmap.nodes.perception_node.input.files.frame_folders import frames_in, read_frame
from tests.extern.frame_folders.recorded import (
    COLOUR,
    DEPTH,
    FRAME,
    HEIGHT,
    INFO,
    MM,
    RGB,
    WIDTH,
    Said,
    compressed,
    instead,
    lens,
    seconds,
    table,
    write,
)
from tests.extern.ros.made import image, info, transforms


def converted(tmp_path, file, *options):
    assert execute(["frames", str(file), str(tmp_path / "out"), *map(str, options)]) == 0
    return frames_in(tmp_path / "out")


def refused(tmp_path, capsys, file, *options):
    assert execute(["frames", str(file), str(tmp_path / "out"), *map(str, options)]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    return error


def picture(folder, name):
    return np.asarray(Image.open(folder / name))


def camera(folder):
    return json.loads((folder / "camera.json").read_text())


@pytest.mark.parametrize("kind", ["bag", "db3", "rosbag2", "mcap", "mcap1"])
def test_a_bag_becomes_folders(tmp_path, capsys, kind):
    folders = converted(tmp_path, write(tmp_path, kind, table()))
    assert [folder.name for folder in folders] == [
        "1700000000.005000000",
        "1700000000.105000000",
        "1700000000.205000000",
    ]
    assert (picture(folders[0], "rgb.png") == RGB).all()
    depth = picture(folders[0], "depth.png")
    assert depth.dtype == np.uint16
    assert (depth == MM).all()
    told = camera(folders[1])
    assert (told["fx"], told["cx"], told["cy"]) == (100.0, WIDTH / 2 + 0.5, HEIGHT / 2 + 0.5)
    assert (told["width"], told["height"]) == (WIDTH, HEIGHT)
    assert np.array(told["map_from_camera"])[:3, 3] == pytest.approx([0.105, 0.0, 1.0])
    frame = read_frame(folders[0])
    assert np.nanmin(frame.cloud.points_camera[..., 2]) == pytest.approx(1.0)
    said = capsys.readouterr().out
    assert f"colour of {COLOUR}, depth of {DEPTH}, camera of {INFO}" in said
    assert "camera poses in odom" in said
    assert "3 frames" in said


def test_a_single_file_of_rosbag2_is_read(tmp_path):
    folder = write(tmp_path, "db3", table())
    (file,) = folder.glob("*.db3")
    assert len(converted(tmp_path, file)) == 3


@pytest.mark.parametrize(
    ("said", "header", "pixels"),
    [
        ("16UC1; compressedDepth png", struct.pack("<Iff", 0, 0, 0), MM),
        ("16UC1; png compressed", b"", MM),
        (
            "32FC1; compressedDepth png",
            struct.pack("<Iff", 0, 10_100.0, -1009.0),
            (10_100_000 / MM - 1009).round().astype(np.uint16),
        ),
    ],
)
def test_compressed_pictures_are_read(tmp_path, said, header, pixels):
    made = instead(table(1), COLOUR, lambda m: compressed(m, RGB, "jpeg", "JPEG"), f"{COLOUR}/compressed")
    made = instead(
        made, DEPTH, lambda m: compressed(m, pixels, said, header=header), f"{DEPTH}/compressedDepth"
    )
    (folder,) = converted(tmp_path, write(tmp_path, "mcap", made))
    assert np.abs(picture(folder, "depth.png").astype(int) - MM).max() <= 1
    assert np.abs(picture(folder, "rgb.png").astype(int) - RGB).mean() < 3


def test_depth_in_metres_is_written_in_millimetres(tmp_path):
    metres = np.where(MM > 1300, np.nan, MM / 1000).astype(np.float32)
    made = instead(table(1), DEPTH, lambda m: image(metres, "32FC1", stamp_ns=seconds(0), frame=FRAME))
    (folder,) = converted(tmp_path, write(tmp_path, "bag", made))
    assert (picture(folder, "depth.png") == np.where(MM > 1300, 0, MM)).all()


@pytest.mark.parametrize(
    ("depth", "encoding", "said", "scale"),
    [
        (MM.astype(np.float32), "32FC1", "beyond 1195 m; the unit is probably millimetres", 0.001),
        (MM * 10, "16UC1", "beyond 12 m; the unit is probably tenths of a millimetre", 0.0001),
        (MM // 1000, "16UC1", "ends at 0.001 m; the unit is probably metres", 1),
    ],
)
def test_depth_in_another_unit_is_reported_with_its_scale(tmp_path, capsys, depth, encoding, said, scale):
    made = instead(table(1), DEPTH, lambda m: image(depth, encoding, stamp_ns=seconds(0), frame=FRAME))
    file = write(tmp_path, "bag", made)
    error = refused(tmp_path, capsys, file)
    assert said in error
    assert f'"depth_scale": {scale}' in error
    (folder,) = converted(tmp_path, file, "--intrinsics", lens(tmp_path / "lens.json", depth_scale=scale))
    assert (picture(folder, "depth.png") == np.round(depth * (1000.0 * scale))).all()


def test_intrinsics_and_colour_of_another_resolution_are_scaled(tmp_path):
    large = RGB.repeat(2, axis=0).repeat(2, axis=1)
    made = instead(table(1), COLOUR, lambda m: image(large, "rgb8", stamp_ns=seconds(0), frame=FRAME))
    made = instead(made, INFO, lambda _: info(2 * WIDTH, 2 * HEIGHT, FRAME))
    (folder,) = converted(tmp_path, write(tmp_path, "mcap", made))
    assert (picture(folder, "rgb.png") == RGB).all()
    told = camera(folder)
    assert (told["fx"], told["cx"]) == (50.0, (WIDTH + 0.5) / 2)


def test_fewer_frames_are_taken(tmp_path):
    file = write(tmp_path, "mcap", table(10))
    assert len(converted(tmp_path, file, "--every", "0.45")) == 2


def test_pictures_pair_once_with_the_nearest_and_the_rest_is_reported(tmp_path, capsys):
    made = table(3)
    late = image(MM, "16UC1", stamp_ns=seconds(0.12), frame=FRAME)  # beside that of 0.105
    alone = image(RGB, "rgb8", stamp_ns=seconds(0.5), frame=FRAME)
    twice = image(RGB, "rgb8", stamp_ns=seconds(0.1), frame=FRAME)
    made += [Said(DEPTH, seconds(0.12), late), Said(COLOUR, seconds(0.5), alone)]
    made.append(Said(COLOUR, seconds(0.1), twice))
    assert len(converted(tmp_path, write(tmp_path, "bag", made))) == 3
    said = capsys.readouterr().out
    assert "1 colour image without a depth image within 0.03 s" in said
    assert "1 image skipped: duplicate stamp" in said


@pytest.mark.parametrize("base", [None, "camera_link"])
def test_poses_need_a_frame_whose_z_is_up(tmp_path, capsys, base):
    made = [one for one in table(1) if one.topic != "/tf"]
    options = () if base is None else ("--base", base)
    (folder,) = converted(tmp_path, write(tmp_path, "bag", made), *options)
    assert ("map_from_camera" in camera(folder)) is (base is not None)
    said = capsys.readouterr().out
    assert ("camera poses in camera_link" if base else "ancestors on /tf: camera_link; ") in said


def test_without_a_camera_pose_the_frame_has_no_pose(tmp_path, capsys):
    made = table(2, apart_s=3.0)
    made.append(Said(DEPTH, seconds(1.5), image(MM, "16UC1", stamp_ns=seconds(1.5), frame=FRAME)))
    made.append(Said(COLOUR, seconds(1.5), image(RGB, "rgb8", stamp_ns=seconds(1.5), frame=FRAME)))
    folders = converted(tmp_path, write(tmp_path, "bag", made))
    assert ["map_from_camera" in camera(folder) for folder in folders] == [True, False, True]
    assert "1 frame without a camera pose" in capsys.readouterr().out


def test_depth_that_is_not_aligned_is_reported(tmp_path, capsys):
    raw = "/camera/depth/image_rect_raw"
    made = instead(
        table(1, moving=False),
        DEPTH,
        lambda _: image(MM, "16UC1", stamp_ns=seconds(0), frame="camera_depth_optical_frame"),
        raw,
    )
    error = refused(tmp_path, capsys, write(tmp_path, "bag", made))
    assert f"({raw}) is not aligned to colour" in error
    assert "camera_depth_optical_frame" in error
    assert not (tmp_path / "out").exists()


def test_two_lenses_are_not_aligned_either(tmp_path, capsys):
    other = info(WIDTH, HEIGHT, FRAME)
    other.k[0] = other.k[4] = 130.0
    made = [*table(1), Said("/camera/aligned_depth_to_color/camera_info", seconds(0), other)]
    assert "have different intrinsics" in refused(tmp_path, capsys, write(tmp_path, "mcap", made))


def test_frames_of_one_place_are_aligned(tmp_path):
    made = instead(table(1), DEPTH, lambda _: image(MM, "16UC1", stamp_ns=seconds(0), frame="depth"))
    made.append(Said("/tf_static", seconds(0), transforms(("depth", FRAME, (0.0, 0.0, 0.0)))))
    assert len(converted(tmp_path, write(tmp_path, "bag", made))) == 1


def test_of_several_topics_one_is_named(tmp_path, capsys):
    other = "/back/color/image_raw"
    made = [*table(1), Said(other, seconds(0), image(RGB[:, ::-1], "rgb8", stamp_ns=seconds(0), frame=FRAME))]
    file = write(tmp_path, "bag", made)
    error = refused(tmp_path, capsys, file)
    assert f"colour images on several topics: {other} and {COLOUR}; choose one with --rgb-topic" in error
    assert "image topics: " in refused(tmp_path, capsys, file, "--rgb-topic", "/front")
    (folder,) = converted(tmp_path, file, "--rgb-topic", other)
    assert (picture(folder, "rgb.png") == RGB[:, ::-1]).all()


@pytest.mark.parametrize(
    ("without", "said"),
    [
        (DEPTH, f"no depth images found; image topics: {COLOUR} (rgb8)"),
        (COLOUR, "no colour images found"),
        (INFO, "no camera_info for"),
    ],
)
def test_what_a_bag_lacks_is_reported(tmp_path, capsys, without, said):
    file = write(tmp_path, "bag", instead(table(1), without, lambda _: None))
    assert said in refused(tmp_path, capsys, file)


def test_a_file_of_intrinsics_takes_the_place_of_camera_info(tmp_path):
    file = write(tmp_path, "bag", instead(table(1), INFO, lambda _: None))
    (folder,) = converted(tmp_path, file, "--intrinsics", lens(tmp_path / "lens.json", depth_scale=0.002))
    assert (picture(folder, "depth.png") == 2 * MM).all()


@pytest.mark.parametrize("kind", ["bag", "mcap", "db3"])
def test_a_file_that_is_cut_off_is_reported(tmp_path, capsys, kind):
    whole = write(tmp_path, kind, table())
    file = next(whole.glob("*.db3")) if kind == "db3" else whole
    file.write_bytes(file.read_bytes()[: file.stat().st_size // 2])
    error = refused(tmp_path, capsys, file)
    assert "truncated, or was not closed by its recorder" in error
    assert not (tmp_path / "out").exists()


def test_intrinsics_that_fit_no_picture_are_reported(tmp_path, capsys):
    file = write(tmp_path, "bag", instead(table(1), INFO, lambda _: info(WIDTH, 3 * HEIGHT, FRAME)))
    assert f"the intrinsics are for {WIDTH} x {3 * HEIGHT}" in refused(tmp_path, capsys, file)


@pytest.mark.parametrize("text", ["sensor_msgs/Image[] a", "uint8[4000000000] a", "uint8", ""])
def test_definitions_in_a_file_are_not_used(tmp_path, monkeypatch, text):
    register = McapWriter.register_schema
    monkeypatch.setattr(
        McapWriter,
        "register_schema",
        lambda self, name, encoding, data: register(self, name, encoding, text.encode()),
    )
    assert len(converted(tmp_path, write(tmp_path, "mcap", table()))) == 3


@pytest.mark.parametrize("function", ["get_summary", "iter_messages"])
def test_a_file_that_needs_too_much_memory_is_reported(tmp_path, capsys, monkeypatch, function):
    def read(*_, **__):
        raise MemoryError

    file = write(tmp_path, "mcap", table())
    monkeypatch.setattr(SeekingReader, function, read)
    assert "needs more memory to read than this machine can give it" in refused(tmp_path, capsys, file)
