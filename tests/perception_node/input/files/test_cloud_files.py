"""Frames from files, valid and invalid."""

from __future__ import annotations

import json

import numpy as np
import pytest
from PIL import Image

from semmap.nodes.perception_node.input.files.cloud_files import read_cloud, read_frames
from semmap.schemas.errors import BadFile, BadRequest
from tests.perception_node.files.made import COLORS, POINTS, header, pcd, ply

CAMERA = {"fx": 10.0, "fy": 10.0, "cx": 3.5, "cy": 2.5}


@pytest.mark.parametrize("encoding", ["ascii", "binary", "binary_compressed"])
def test_pcd(tmp_path, encoding):
    file = tmp_path / "cloud.pcd"
    file.write_bytes(pcd(encoding))
    cloud = read_cloud(file)
    assert cloud.organised
    np.testing.assert_array_equal(cloud.points_camera, POINTS.reshape(3, 4, 3))
    np.testing.assert_array_equal(cloud.colors, COLORS.reshape(3, 4, 3))


def test_pcd_with_colours_called_floats_and_fields_of_several_numbers(tmp_path):
    head = header("binary", fields="x y z rgb fpfh", height=1, width=12).replace(b"1 1 1 1 1", b"1 1 1 1 3")
    packed = np.full(12, 0x0A0B0C, np.uint32).view(np.float32)
    rows = np.column_stack([POINTS, packed.view(np.float32), np.zeros((12, 3), np.float32)])
    file = tmp_path / "cloud.pcd"
    file.write_bytes(head + rows.astype(np.float32).tobytes())
    cloud = read_cloud(file)
    assert not cloud.organised
    assert cloud.points_camera.shape == (1, 12, 3)
    assert (cloud.colors == [0x0A, 0x0B, 0x0C]).all()


@pytest.mark.parametrize("encoding", ["ascii", "binary_little_endian", "binary_big_endian"])
def test_ply(tmp_path, encoding):
    file = tmp_path / "cloud.ply"
    file.write_bytes(ply(encoding))
    cloud = read_cloud(file)
    np.testing.assert_array_equal(cloud.points_camera, POINTS[None])
    np.testing.assert_array_equal(cloud.colors, COLORS[None])


def write_pictures(folder, *, color=(8, 6), depth=(8, 6)):
    Image.fromarray(np.full((color[1], color[0], 3), 7, np.uint8)).save(folder / "rgb.png")
    values = np.full((depth[1], depth[0]), 2000, np.uint16)
    values[0, 0] = 0
    Image.fromarray(values).save(folder / "depth.png")
    (folder / "lens.json").write_text(json.dumps(CAMERA))
    return folder / "rgb.png", folder / "depth.png", folder / "lens.json"


@pytest.mark.parametrize("swapped", [False, True])
def test_pictures(tmp_path, swapped):
    rgb, depth, camera = write_pictures(tmp_path)
    files = (depth, rgb) if swapped else (rgb, depth)
    [(file, cloud)] = read_frames(files, camera)
    assert file == depth
    assert cloud.points_camera.shape == (6, 8, 3)
    assert np.isnan(cloud.points_camera[0, 0]).all()
    np.testing.assert_allclose(cloud.points_camera[5, 7], [3.5 * 2 / 10, 2.5 * 2 / 10, 2.0], rtol=1e-6)
    assert (cloud.colors == 7).all()


def test_pictures_of_different_sizes_are_refused(tmp_path):
    rgb, depth, camera = write_pictures(tmp_path, depth=(4, 3))
    with pytest.raises(BadFile, match="colour is 8 x 6 pixels, depth 4 x 3"):
        list(read_frames((rgb, depth), camera))


def test_pictures_need_intrinsics_and_depth(tmp_path):
    rgb, depth, camera = write_pictures(tmp_path)
    with pytest.raises(BadRequest, match="--intrinsics"):
        list(read_frames((rgb, depth)))
    with pytest.raises(BadFile, match="depth image"):
        list(read_frames((rgb, rgb), camera))


@pytest.mark.parametrize(
    ("numbers", "said"),
    [
        (np.full((6, 8), 2.0, np.float32), None),
        (np.full((6, 8), 2000.0, np.float32), 'millimetres; set "depth_scale": 0.001'),
        (np.full((6, 8), 2, np.uint16), 'probably metres; set "depth_scale": 1 in'),
        (np.full((6, 8), 13_000, np.uint16), 'tenths of a millimetre; set "depth_scale": 0.0001 in'),
        (np.full((6, 8), 90, np.uint16), 'probably centimetres; set "depth_scale": 0.01 in'),
    ],
)
def test_depth_in_floats_is_in_metres_and_another_unit_is_told(tmp_path, numbers, said):
    _, depth, camera = write_pictures(tmp_path)
    Image.fromarray(numbers).save(depth, "TIFF")
    if said is None:
        [(_, cloud)] = read_frames((depth,), camera)
        assert (cloud.points_camera[..., 2] == 2.0).all()
        return
    with pytest.raises(BadFile, match=said):
        list(read_frames((depth,), camera))


SCALED = [2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1]


@pytest.mark.parametrize(
    "content",
    [
        "",
        "[]",
        '{"fx": 0, "fy": 1, "cx": 1, "cy": 1}',
        json.dumps({**CAMERA, "map_from_camera": [1]}),
        json.dumps({**CAMERA, "map_from_camera": SCALED}),
    ],
)
def test_bad_intrinsics_are_refused(tmp_path, content):
    rgb, depth, camera = write_pictures(tmp_path)
    camera.write_text(content)
    with pytest.raises(BadFile, match=r"lens\.json"):
        list(read_frames((rgb, depth), camera))


def test_the_camera_of_a_folder_of_frames_will_do(tmp_path):
    rgb, depth, camera = write_pictures(tmp_path)
    camera.write_text(json.dumps({**CAMERA, "width": 8, "height": 6, "map_from_camera": np.eye(4).tolist()}))
    [(_, cloud)] = read_frames((rgb, depth), camera)
    assert (cloud.map_from_camera == np.eye(4)).all()
    camera.write_text(json.dumps({**CAMERA, "width": 640, "height": 480}))
    with pytest.raises(BadFile, match="images of 640 x 480; this one has 8 x 6 pixels"):
        list(read_frames((rgb, depth), camera))


def test_the_intrinsics_of_another_camera_is_told(tmp_path):
    rgb, depth, camera = write_pictures(tmp_path)
    camera.write_text(json.dumps({**CAMERA, "cx": 319.5}))
    with pytest.raises(BadFile, match=r"fx 10 .* cx 319\.5 .* do not fit an image of 8 x 6 pixels"):
        list(read_frames((rgb, depth), camera))


def test_a_folder_is_told_how_to_give_it(tmp_path):
    with pytest.raises(BadFile, match=r"is a folder; .* semmap perceive --frames "):
        read_cloud(tmp_path)


def test_what_is_no_cloud_is_refused_in_one_line(tmp_path):
    whole = pcd("binary_compressed")
    cases = {
        "missing.pcd": None,
        "nothing.pcd": b"",
        "text.pcd": b"hello\n" * 400,
        "truncated.pcd": whole[:-20],
        "headless.pcd": whole[200:],
        "short.pcd": pcd("ascii")[:-30],
        "letters.pcd": header("ascii") + b"a b c d e " * 12,
        "unknown.pcd": header("zip"),
        "huge.pcd": header("binary", width=2_000_000_000, height=1000),
        "flat.pcd": header("ascii", fields="x y label rgba rgba"),
        "empty.pcd": header("binary", width=0, height=0),
        "one.pcd": header("ascii", fields="x y z", width=1, height=1) + b"0 0 1\n",
        "millimetres.pcd": header("ascii", fields="x y z") + b"300 200 1000\n" * 12,
        "blind.pcd": header("ascii", fields="x y z") + b"nan nan nan\n" * 12,
        "nothing.ply": b"",
        "truncated.ply": ply("binary_little_endian")[:-40],
        "unknown.ply": b"ply\nformat zip 1.0\nelement vertex 1\nproperty float x\nend_header\n",
        "cloud.xyz": b"0 0 1\n",
    }
    for name, content in cases.items():
        file = tmp_path / name
        if content is not None:
            file.write_bytes(content)
        with pytest.raises(BadFile, match=name) as caught:
            read_cloud(file)
        assert "\n" not in caught.value.text
    (tmp_path / "folder.pcd").mkdir()
    with pytest.raises(BadFile, match="directory"):
        read_cloud(tmp_path / "folder.pcd")


def test_odd_numbers_in_text_are_no_trouble(tmp_path):
    rows = b"nan nan nan nan 0\n" + b"0 0 1 7 0\n" * 11
    (tmp_path / "labels.pcd").write_bytes(header("ascii", fields="x y z label rgba") + rows)
    assert read_cloud(tmp_path / "labels.pcd").measured == 11
    head = b"ply\nformat ascii 1.0\nelement vertex 10\n"
    head += b"".join(b"property float %s\n" % name for name in (b"x", b"y", b"z", b"red", b"green", b"blue"))
    (tmp_path / "colours.ply").write_bytes(head + b"end_header\n" + b"0 0 1 nan 300 -1\n" * 10)
    assert read_cloud(tmp_path / "colours.ply").colors[0, 0].tolist() == [0, 255, 0]


def written(tmp_path, points):
    file = tmp_path / "cloud.pcd"
    head = header("binary", fields="x y z", height=1, width=len(points))
    file.write_bytes(head + points.astype("<f4").tobytes())
    return file


def test_a_cloud_whose_z_points_backwards_is_turned(tmp_path):
    turned = read_cloud(written(tmp_path, POINTS * [1, -1, -1]))
    np.testing.assert_array_equal(turned.points_camera, POINTS[None])


@pytest.mark.parametrize(
    ("order", "signs"),
    [
        pytest.param((2, 0, 1), (1, -1, -1), id="x forward, y left, z up"),
        pytest.param((0, 2, 1), (1, 1, -1), id="x right, y forward, z up"),
    ],
)
def test_a_cloud_with_the_axes_of_a_robot_is_turned(tmp_path, order, signs):
    around = POINTS + np.float32([-0.55, -0.7, 0.0])  # above, below, left and right of the optical axis
    around[::2, 1] *= -1
    turned = read_cloud(written(tmp_path, around[:, order] * np.float32(signs)))
    np.testing.assert_array_equal(turned.points_camera, around[None])


def test_a_cloud_that_is_all_around_its_camera_is_refused(tmp_path):
    around = np.random.default_rng(1).normal(size=(200, 3)).astype(np.float32)
    with pytest.raises(BadFile, match=r"\d+% of its points are behind .* --up z"):
        read_cloud(written(tmp_path, around))


def test_a_point_behind_the_camera_turns_nothing(tmp_path):
    points = POINTS.copy()
    points[0, 2] = -1.0
    seen = read_cloud(written(tmp_path, points)).points_camera[0]
    assert np.isnan(seen[0]).all()
    np.testing.assert_array_equal(seen[1:], POINTS[1:])


@pytest.mark.parametrize("sign", [1, -1])
def test_a_cloud_in_millimetres_is_told_with_the_factor(tmp_path, sign):
    with pytest.raises(BadFile, match=r"is 1000 m; .* multiply them by 0\.001"):
        read_cloud(written(tmp_path, sign * 1000 * POINTS))


def test_a_cloud_in_centimetres_is_told_with_the_factor(tmp_path):
    with pytest.raises(BadFile, match=r"is 200 m; .* centimetres: multiply them by 0\.01$"):
        read_cloud(written(tmp_path, 200 * POINTS))
