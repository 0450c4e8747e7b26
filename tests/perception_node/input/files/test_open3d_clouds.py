"""Cloud files that Open3D reads."""

from __future__ import annotations

from importlib.util import find_spec

import numpy as np
import pytest

from semmap.nodes.perception_node.input.files import open3d_clouds
from semmap.nodes.perception_node.input.files.cloud_files import read_cloud
from semmap.schemas.errors import BadFile

POINTS = np.column_stack([np.arange(12) / 10, np.full(12, 0.5), np.full(12, 1.0)])
ROWS = [" ".join(map(str, row)) for row in POINTS.tolist()]
CAMERA_FIRST = """ply
format ascii 1.0
element camera 1
property float view
element vertex 12
property float x
property float y
property float z
end_header
7
"""
LISTS = """ply
format ascii 1.0
element vertex 12
property float x
property float y
property float z
property list uchar int of
end_header
"""
OLD = """# .PCD v.5 - Point Cloud Data file format
VERSION .5
COLUMNS x y z
SIZE 4 4 4
TYPE F F F
POINTS 12
DATA ascii
"""
FILES = {
    "plain.xyz": "\n".join(ROWS),
    "normals.xyzn": "\n".join(f"{row} 0 0 1" for row in ROWS),
    "coloured.xyzrgb": "\n".join(f"{row} 1 0.5 0" for row in ROWS),
    "scanned.PTS": "\n".join(["12", *(f"{row} -900 255 128 0" for row in ROWS)]),
    "camera.ply": CAMERA_FIRST + "\n".join(ROWS),
    "lists.ply": LISTS + "\n".join(f"{row} 1 4" for row in ROWS),
    "old.pcd": OLD + "\n".join(ROWS) + "\n",
}

needs_open3d = pytest.mark.skipif(find_spec("open3d") is None, reason="Open3D is not installed")


@needs_open3d
@pytest.mark.parametrize("name", FILES)
def test_what_we_do_not_read_ourselves_is_read(tmp_path, name):
    (tmp_path / name).write_text(FILES[name])
    cloud = read_cloud(tmp_path / name)
    np.testing.assert_allclose(cloud.points_camera, POINTS[None], atol=1e-6)
    coloured = name.endswith(("rgb", "PTS"))
    assert (cloud.colors is not None) == coloured
    if coloured:
        assert (cloud.colors == [255, 128, 0]).all()


@needs_open3d
@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("empty.xyz", "", "no points in it"),
        ("words.xyz", "hello\n" * 20, "no points in it"),
        ("headless.pts", "\n".join(ROWS), "must be its number of points"),
        ("short.pts", "\n".join(["20", *ROWS]), "truncated: 12 of 20 points"),
        ("huge.pts", "3000000000\n", "must be its number of points"),
        ("millimetres.xyz", "300 200 1000\n" * 12, r"multiply them by 0\.001"),
        ("few.xyz", "0 0 1\n", "1 point "),
        ("missing.xyz", None, "No such file"),
    ],
)
def test_what_is_wrong_is_said_in_one_line(tmp_path, capfd, name, content, said):
    if content is not None:
        (tmp_path / name).write_text(content)
    with pytest.raises(BadFile, match=said) as caught:
        read_cloud(tmp_path / name)
    assert name in caught.value.text
    assert "\n" not in caught.value.text
    assert "Open3D" not in "".join(capfd.readouterr())


@pytest.mark.parametrize("name", ["plain.xyz", "scanned.PTS", "camera.ply", "old.pcd"])
def test_without_open3d_it_is_said_what_would_read_it(tmp_path, monkeypatch, name):
    monkeypatch.setattr(open3d_clouds, "find_spec", lambda module: None)
    (tmp_path / name).write_text(FILES[name])
    with pytest.raises(BadFile, match="requires Open3D, which is not installed") as caught:
        read_cloud(tmp_path / name)
    assert "perception" in caught.value.text
    assert "\n" not in caught.value.text
