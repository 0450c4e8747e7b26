"""Round trip: recorded clouds are converted to a recording, to folders, and perceived."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from PIL import Image

from semmap.nodes.extern.cli.app import execute
from semmap.nodes.extern.ros.types import new
from semmap.nodes.perception_node.image_features import image_evidence
from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.input.files.cloud_files import read_cloud
from semmap.nodes.perception_node.pipeline import FrameResult, observe_clouds
from semmap.nodes.perception_node.recognition.recognition_model import shipped
from tests.data import data_folder
from tests.extern.frame_folders.recorded import COLOUR, DEPTH, FRAME, INFO, Said, lens, seconds, write
from tests.extern.ros.made import image, stamped

SCENES = ("learn24", "learn33", "learn12")
KINECT = {"fx": 525.0, "fy": 525.0, "cx": 319.5, "cy": 239.5}
"""The camera that took them, the middle of the first pixel at 0."""
ROUNDED = 1e-4
"""Of the pixels so few may be another thing's: a file in text and one of millimetres differ by 1e-7 m."""


class Table(NamedTuple):
    """A scene's pictures, (H, W, 3) and (H, W) [mm], and what its cloud shows."""

    rgb: np.ndarray
    mm: np.ndarray
    seen: FrameResult


@pytest.fixture(scope="module")
def tables() -> list[Table]:
    """Some recorded scenes, looked at as clouds."""
    files = [data_folder() / "mosd" / f"{name}.pcd" for name in SCENES]
    if not all(file.exists() for file in files):
        pytest.skip(f"no recorded scenes in {data_folder()}")
    return [pictured(read_cloud(file)) for file in files]


def pictured(cloud: Cloud) -> Table:
    assert cloud.colors is not None
    depth_m = np.nan_to_num(cloud.points_camera[..., 2])
    return Table(
        cloud.colors,
        np.round(depth_m * 1000).astype(np.uint16),
        observe_clouds([cloud], shipped()),
    )


@pytest.mark.parametrize("kind", ["bag", "mcap", "tum"])
def test_a_recording_shows_what_its_clouds_show(tmp_path, monkeypatch, tables, kind):
    # A pixel more or less may change what images say of a doubtful thing, and so its size.
    monkeypatch.setattr(image_evidence, "available", lambda: False)
    recording, options = (
        as_tum(tmp_path, tables) if kind == "tum" else (write(tmp_path, kind, as_messages(tables)), [])
    )
    assert execute(["frames", str(recording), str(tmp_path / "folders"), *options]) == 0
    rows, labels = tmp_path / "rows.json", tmp_path / "labels"
    words = ["perceive", "--frames", tmp_path / "folders", "--json", rows, "--labels", labels]
    assert execute([*map(str, words)]) == 0
    told = json.loads(rows.read_text())
    assert len(told) == len(tables)
    for row, table in zip(told, tables, strict=True):
        here, there = np.load(labels / f"{row['frame']}.npy"), table.seen.labels[0]
        expected = table.seen.observations.observations
        assert len(row["objects"]) == len(expected)
        assert np.mean(here != there) < ROUNDED
        for found, observation in zip(row["objects"], expected, strict=True):
            assert found["points"] == pytest.approx(observation.points, rel=0.01)
            assert found["size_m"] == pytest.approx(observation.size_m, abs=2.5e-3)


def as_messages(tables: list[Table]) -> list[Said]:
    """The pictures as a Kinect's driver publishes them, one a second."""
    height, width = tables[0].mm.shape
    k = np.array([KINECT["fx"], 0, KINECT["cx"], 0, KINECT["fy"], KINECT["cy"], 0, 0, 1])
    camera: Any = new("sensor_msgs/msg/CameraInfo", header=stamped(FRAME, 0), width=width, height=height, k=k)
    said = [Said(INFO, seconds(0), camera)]
    for n, table in enumerate(tables):
        at = seconds(n)
        said.append(Said(COLOUR, at, image(table.rgb, "rgb8", stamp_ns=at, frame=FRAME)))
        said.append(Said(DEPTH, at, image(table.mm, "16UC1", stamp_ns=at, frame=FRAME)))
    return said


def as_tum(folder: Path, tables: list[Table]) -> tuple[Path, list[str]]:
    """The same in two folders of pictures that are called by their seconds, and what the camera is like."""
    for n, table in enumerate(tables):
        for kind, pixels in (("rgb", table.rgb), ("depth", table.mm * 5)):
            (folder / "tum" / kind).mkdir(parents=True, exist_ok=True)
            Image.fromarray(pixels).save(folder / "tum" / kind / f"{1305031102 + n}.000000.png")
    return folder / "tum", ["--intrinsics", str(lens(folder / "lens.json", **KINECT))]
