"""`semmap frames RECORDING DIR` on folders in the TUM format, and its errors."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from semmap.nodes.extern.cli.app import execute
from semmap.nodes.perception_node.input.files.frame_folders import frames_in
from tests.extern.frame_folders.recorded import HEIGHT, MM, RGB, WIDTH, lens, tum


@pytest.fixture
def recording(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    lens(tmp_path / "lens.json")
    return tum(tmp_path / "desk")


def converted(*options):
    assert execute(["frames", "desk", "out", "--intrinsics", "lens.json", *options]) == 0
    return frames_in(Path("out"))


def test_pictures_and_poses_become_folders(recording, capsys):
    folders = converted()
    assert folders[0].name == "1305031102.000000000"
    assert len(folders) == 3
    assert (np.asarray(Image.open(folders[0] / "rgb.png")) == RGB).all()
    assert (np.asarray(Image.open(folders[0] / "depth.png")) == MM).all()
    told = json.loads((folders[1] / "camera.json").read_text())
    assert np.array(told["map_from_camera"])[:3, 3] == pytest.approx([0.1, 0.0, 1.0], abs=1e-3)
    assert told["cx"] == WIDTH / 2 + 0.5
    assert "1 m is 5000 in depth images" in capsys.readouterr().out


def test_pictures_that_nothing_lists_go_by_their_names(recording, capsys):
    for name in ("rgb.txt", "depth.txt", "groundtruth.txt"):
        (recording / name).unlink()
    (recording / "rgb" / "notes.md").write_text("mine")
    folders = converted()
    assert len(folders) == 3
    assert "map_from_camera" not in (folders[0] / "camera.json").read_text()
    assert "no camera poses: there is no file groundtruth.txt" in capsys.readouterr().out


def test_the_scale_of_another_camera_is_reported_with_its_intrinsics(recording, tmp_path):
    lens(tmp_path / "lens.json", depth_scale=0.0001)
    folders = converted()
    assert (np.asarray(Image.open(folders[0] / "depth.png")) == MM / 2).all()


def test_cameras_of_tum_are_known_by_name(recording, tmp_path):
    recording.rename(tmp_path / "rgbd_dataset_freiburg1_desk")
    assert execute(["frames", "rgbd_dataset_freiburg1_desk", "out"]) == 2  # those are 640 x 480, these 3 : 2


def test_a_frame_that_cannot_be_read_is_reported_and_the_others_go_on(recording, capsys):
    first = sorted((recording / "depth").iterdir())[0]
    first.write_bytes(first.read_bytes()[:60])
    assert len(converted()) == 2
    error = capsys.readouterr().err
    assert "1 frame skipped; first error: " in error
    assert "not an image, or a truncated one" in error


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["desk", "out"], "unknown camera; add --intrinsics"),
        (["desk", "desk", "--intrinsics", "lens.json"], "desk is not empty"),
        (["nowhere.bag", "out"], "there is no file or folder nowhere.bag"),
        (["lens.json", "out"], "is not a recording; supported: .bag, .db3, .mcap"),
        (["empty", "out"], "no rgb.txt and no folder rgb"),
        (["desk", "out", "--depth-topic", "/d"], "is not a rosbag"),
        (["desk.bag"], "semmap frames desk.bag DIR"),
        (["--every", "2"], "--every requires a recording"),
        (["desk", "out", "--format", "tree"], "--format tree applies to the frame tree only"),
        (["desk", "out", "--intrinsics", "lens.json", "--within", "0.001"], "use a larger --within"),
        (["desk", "out", "--intrinsics", "wrong.json"], "do not fit an image of"),
    ],
)
def test_what_cannot_be_done_is_reported_in_one_line(recording, tmp_path, capsys, words, said):
    (tmp_path / "empty").mkdir()
    (tmp_path / "wrong.json").write_text(json.dumps({"fx": 1, "fy": 1, "cx": WIDTH, "cy": HEIGHT}))
    assert execute(["frames", *words]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1


def test_a_recording_that_needs_too_much_memory_is_reported_in_one_line(recording, capsys, monkeypatch):
    def fail(*_):
        raise MemoryError

    monkeypatch.setattr("semmap.nodes.extern.frame_folders.frames.write", fail)
    assert execute(["frames", "desk", "out", "--intrinsics", "lens.json"]) == 2
    assert capsys.readouterr().err == (
        "semmap: desk needs more memory to read than this machine can give it\n"
    )


def test_intrinsics_of_another_resolution_are_noted(recording, tmp_path, capsys):
    (tmp_path / "small.json").write_text(json.dumps({"fx": 100, "fy": 100, "cx": WIDTH, "cy": HEIGHT}))
    assert execute(["frames", "desk", "out", "--intrinsics", "small.json"]) == 0
    error = capsys.readouterr().err
    assert error.count("note: desk: the intrinsics fx 100 ") == 1
    assert f"cx {WIDTH / 2:g}, cy {HEIGHT / 2:g}" in error


def test_colour_and_depth_of_two_sizes_are_reported(recording, capsys):
    for file in (recording / "rgb").iterdir():
        Image.fromarray(RGB[:, ::2]).save(file)
    assert execute(["frames", "desk", "out", "--intrinsics", "lens.json"]) == 2
    assert "is 30 x 40 pixels" in capsys.readouterr().err
