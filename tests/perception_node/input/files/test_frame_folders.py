"""Reading of folders of frames, and the errors for invalid ones."""

from __future__ import annotations

import json
import re

import numpy as np
import pytest
from PIL import Image

from semmap.nodes.perception_node.input.files.cloud_files import read_frames
from semmap.nodes.perception_node.input.files.frame_folders import frames_in, read_frame
from semmap.schemas.errors import BadFile

CAMERA = {"fx": 60.0, "fy": 60.0, "cx": 32.0, "cy": 24.0}


def write_frame(folder, *, depth=None, size=(64, 48), **camera):
    folder.mkdir(parents=True)
    Image.new("RGB", size, (10, 200, 30)).save(folder / "rgb.png")
    depth = np.full((48, 64), 1500, np.uint16) if depth is None else depth
    Image.fromarray(depth).save(folder / "depth.png")
    (folder / "camera.json").write_text(json.dumps({**CAMERA, **camera}))
    return folder


def test_a_frame_is_its_cloud_with_colours(tmp_path):
    frame = read_frame(write_frame(tmp_path / "a"))
    assert frame.shape == (48, 64)
    assert frame.cloud.map_from_camera is None
    assert frame.cloud.points_camera[23, 31] == pytest.approx((-0.0125, -0.0125, 1.5))
    assert frame.cloud.colors[0, 0].tolist() == [10, 200, 30]


@pytest.mark.parametrize("flat", [True, False])
def test_a_pose_is_sixteen_numbers_or_four_rows(tmp_path, flat):
    pose = np.eye(4)
    pose[:3, 3] = 1.0, 2.0, 3.0
    said = pose.ravel().tolist() if flat else pose.tolist()
    frame = read_frame(write_frame(tmp_path / "a", map_from_camera=said))
    assert frame.cloud.map_from_camera.tolist() == pose.tolist()


def test_depth_is_in_the_unit_that_the_camera_tells(tmp_path):
    depth = np.full((48, 64), 15_000, np.uint16)
    frame = read_frame(write_frame(tmp_path / "a", depth=depth, depth_scale=0.0001))
    assert frame.cloud.points_camera[0, 0, 2] == pytest.approx(1.5)


def test_a_large_picture_is_thinned(tmp_path):
    large = np.full((1200, 1600), 2000, np.uint16)
    lens = {"fx": 1500.0, "fy": 1500.0, "cx": 800.0, "cy": 600.0}
    frame = read_frame(write_frame(tmp_path / "a", depth=large, size=(1600, 1200), **lens))
    assert (frame.step, frame.shape, frame.cloud.points_camera.shape) == (3, (1200, 1600), (400, 534, 3))


@pytest.mark.parametrize(
    ("made", "said"),
    [
        ({"depth": np.full((24, 32), 900, np.uint16)}, "colour is 64 x 48 pixels, depth 32 x 24"),
        ({"depth": np.full((48, 64), 2, np.uint16)}, 'set "depth_scale": 1 in camera.json'),
        ({"depth": np.full((48, 64), 15_000, np.uint16)}, 'set "depth_scale": 0.0001 in camera.json'),
        ({"depth_scale": 5000}, 'set "depth_scale": 0.0002 in camera.json'),
        ({"depth_scale": 0}, "depth_scale must be positive"),
        ({"depth": np.full((48, 64), 200, np.uint8)}, "16 bits"),
        ({"depth": np.zeros((48, 64), np.uint16)}, "no depth"),
        ({"width": 640, "height": 480}, "images of 640 x 480; this one has 64 x 48 pixels"),
        ({"cx": 320.0, "cy": 240.0, "fx": 60.0, "fy": 60.0}, "do not fit an image of 64 x 48 pixels"),
        ({"map_from_camera": [[1, 2], [3]]}, "4 x 4 pose matrix"),
        ({"fx": 6.0, "fy": 6.0}, "fx and fy are probably about 58"),
        ({"fx": "wide"}, "fx"),
    ],
)
def test_what_is_wrong_is_said_with_the_frame_and_its_file(tmp_path, made, said):
    with pytest.raises(BadFile, match=said) as error:
        read_frame(write_frame(tmp_path / "table7", **made))
    assert error.value.text.startswith("table7/")


@pytest.mark.parametrize(
    ("camera", "note"),
    [
        ({}, ""),
        (
            {"cx": 16.0, "cy": 12.0, "fx": 30.0, "fy": 30.0},
            r"from 32 x 24 pixels, fx is about 60.*cx 32,",
        ),
        ({"fx": 250.0, "fy": 250.0}, "fx and fy are probably about 58"),
    ],
)
def test_unusual_intrinsics_are_noted(tmp_path, camera, note):
    notes = " ".join(read_frame(write_frame(tmp_path / "table7", **camera)).cloud.notes)
    assert re.search(f"^camera.json: .*{note}", notes) if note else notes == ""


def test_a_frame_has_the_same_points_by_its_folder_and_by_its_files(tmp_path):
    folder = write_frame(tmp_path / "table7", first_seen="by robot 3")
    in_place = read_frame(folder).cloud
    pictures = [folder / "rgb.png", folder / "depth.png"]
    ((_, by_files),) = read_frames(pictures, folder / "camera.json")
    assert by_files.points_camera.tolist() == in_place.points_camera.tolist()
    assert by_files.intrinsics.tolist() == in_place.intrinsics.tolist()


def test_openexr_is_told_what_to_convert_it_to(tmp_path):
    folder = write_frame(tmp_path / "table7")
    (folder / "depth.png").rename(folder / "depth.exr")
    with pytest.raises(BadFile, match=r"table7/depth\.exr: OpenEXR is not supported; convert it to a TIFF"):
        read_frame(folder)
    with pytest.raises(BadFile, match="OpenEXR is not supported; convert it to a TIFF"):
        list(read_frames([folder / "rgb.png", folder / "depth.exr"], folder / "camera.json"))


def test_half_a_frame_is_told_what_it_lacks(tmp_path):
    folder = write_frame(tmp_path / "table7")
    for name, lacks in (
        ("depth.png", "depth.png"),
        ("camera.json", "depth.png and camera.json"),
        ("rgb.png", "rgb.png, depth.png and camera.json"),
    ):
        (folder / name).unlink()
        with pytest.raises(BadFile) as error:
            read_frame(folder)
        assert error.value.text == f"table7 lacks {lacks}"


def test_a_truncated_picture_is_said_to_be_one(tmp_path):
    picture = write_frame(tmp_path / "table7") / "rgb.png"
    picture.write_bytes(picture.read_bytes()[:60])
    with pytest.raises(BadFile, match=r"table7/rgb\.png: .*truncated"):
        read_frame(tmp_path / "table7")


def test_frames_are_the_folders_in_the_order_of_their_names(tmp_path):
    for name in ("b", "a10", "a9"):
        (tmp_path / name).mkdir()
    (tmp_path / "readme.txt").touch()
    assert [path.name for path in frames_in(tmp_path)] == ["a10", "a9", "b"]


def test_a_frame_is_a_dataset_of_itself(tmp_path):
    folder = write_frame(tmp_path / "table7")
    assert frames_in(folder) == [folder]


def test_a_folder_without_frames_is_refused(tmp_path):
    with pytest.raises(BadFile, match="no folders of frames"):
        frames_in(tmp_path)
    with pytest.raises(BadFile, match="cannot be read"):
        frames_in(tmp_path / "missing")


def test_depth_in_floats_is_in_metres(tmp_path):
    folder = write_frame(tmp_path / "table7")
    Image.fromarray(np.full((48, 64), 1.5, np.float32)).save(folder / "depth.png", "TIFF")
    assert (read_frame(folder).cloud.points_camera[..., 2] == 1.5).all()


def test_a_frame_may_have_other_formats(tmp_path):
    folder = write_frame(tmp_path / "table7")
    whole = read_frame(folder).cloud
    np.save(folder / "depth.npy", np.full((48, 64), 1.5))
    with Image.open(folder / "rgb.png") as image:
        image.save(folder / "rgb.jpg", quality=95)
    by_column = [60.0, 0, 0, 0, 60.0, 0, 31.5, 23.5, 1]
    (folder / "camera.json").write_text(json.dumps({"intrinsic_matrix": by_column}))
    for name in ("rgb.png", "depth.png"):
        (folder / name).unlink()
    same = read_frame(folder).cloud
    assert same.points_camera == pytest.approx(whole.points_camera)
    assert np.abs(same.colors.astype(int) - whole.colors).max() < 10


def test_a_recording_is_told_what_to_do_with_it(tmp_path):
    (tmp_path / "desk" / "rgb").mkdir(parents=True)
    (tmp_path / "desk" / "depth").mkdir()
    (tmp_path / "desk.bag").touch()
    for name in ("desk", "desk.bag"):
        with pytest.raises(BadFile, match=r"semmap frames .*desk"):
            frames_in(tmp_path / name)


def test_a_hidden_folder_is_no_frame(tmp_path):
    (tmp_path / ".unfinished").mkdir()
    (tmp_path / "a").mkdir()
    assert frames_in(tmp_path) == [tmp_path / "a"]
