"""Depth images in several formats."""

import numpy as np
import pytest
from PIL import Image

from semmap.nodes.perception_node.input.files.depth_files import is_depth, read_depth, to_metres

NUMBERS = np.arange(12, dtype=np.uint16).reshape(3, 4) * 300


def written(path, numbers=NUMBERS):
    match path.suffix:
        case ".npy":
            np.save(path, numbers)
        case ".npz":
            np.savez_compressed(path, depth=numbers, colour=np.zeros(3))
        case ".pgm":
            height, width = numbers.shape
            head = f"P5\n# made\n{width} {height}\n10000\n".encode()
            path.write_bytes(head + numbers.astype(">u2").tobytes())
        case _:
            Image.fromarray(numbers).save(path)
    return path


@pytest.mark.parametrize("suffix", ["png", "tiff", "pgm", "npy", "npz"])
def test_the_numbers_are_those_of_the_file(tmp_path, suffix):
    path = written(tmp_path / f"depth.{suffix}")
    assert is_depth(path)
    np.testing.assert_array_equal(read_depth(path), NUMBERS)
    np.testing.assert_allclose(to_metres(read_depth(path), None, "it"), NUMBERS / 1000, rtol=1e-6)


def test_a_text_pgm_is_read(tmp_path):
    path = tmp_path / "depth.pgm"
    path.write_text("P2\n4 3 # wide\n4000\n" + " ".join(map(str, NUMBERS.ravel())) + "\n")
    np.testing.assert_array_equal(read_depth(path), NUMBERS)


@pytest.mark.parametrize("kind", [np.float16, np.float32, np.float64])
@pytest.mark.parametrize("shape", [(3, 4), (3, 4, 1), (1, 3, 4)])
def test_floats_are_metres(tmp_path, kind, shape):
    path = written(tmp_path / "depth.npy", np.full(shape, 1.25, kind))
    depth_m = to_metres(read_depth(path), None, "it")
    assert depth_m.shape == (3, 4)
    assert (depth_m == 1.25).all()


def test_a_single_array_of_an_archive_may_have_any_name(tmp_path):
    np.savez(tmp_path / "depth.npz", NUMBERS)
    np.testing.assert_array_equal(read_depth(tmp_path / "depth.npz"), NUMBERS)
    np.savez(tmp_path / "depth.npz", a=NUMBERS, b=NUMBERS)
    with pytest.raises(ValueError, match="the arrays a and b; name the depth image depth"):
        read_depth(tmp_path / "depth.npz")


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("depth.npy", b"no array"),
        ("depth.npy", b""),
        ("depth.npz", b"PK no archive"),
        ("depth.pgm", b"P5 4 3 255\n" + bytes(12)),
        ("depth.pgm", b"P5 4 3 65535\n" + bytes(5)),
        ("depth.pgm", b"P5 400000 300000 65535\n" + bytes(5)),
        ("depth.pgm", b"P2 4 3 65535\n1 2 x"),
        ("depth.pgm", b"GIF"),
        ("depth.png", b"no image"),
    ],
)
def test_what_is_no_depth_image_is_refused(tmp_path, name, content):
    (tmp_path / name).write_bytes(content)
    with pytest.raises(ValueError, match=r"\w"):
        read_depth(tmp_path / name)


@pytest.mark.parametrize("numbers", [np.zeros((3, 4, 3), np.uint8), np.zeros((3, 4), np.uint8), np.zeros(4)])
def test_an_array_of_something_else_is_refused(tmp_path, numbers):
    np.save(tmp_path / "depth.npy", numbers)
    with pytest.raises(ValueError, match=r"is not a depth image; it must be an array \(height, width\)"):
        read_depth(tmp_path / "depth.npy")


@pytest.mark.parametrize(
    ("depth", "scale", "said"),
    [
        (1000, 5000, 'probably 1/5000 m; set "depth_scale": 0.0002 in camera.json'),
        (1000, 1.0, 'half of its depth is beyond 1000 m; .* set "depth_scale": 0.001'),
        (60_000, 0.001, 'half of its depth is beyond 60 m; .* set "depth_scale": 0.0001'),
        (1500, 1e-7, 'ends at 0.00015 m; .* set "depth_scale": 0.001'),
        (1500, 0.001, None),
        (80, 0.001, None),
        (9000, 0.001, None),
    ],
)
def test_an_impossible_stated_scale_is_told_with_the_likely_one(depth, scale, said):
    numbers = np.full((3, 4), depth, np.uint16)
    if said is None:
        assert to_metres(numbers, scale, "camera.json") == pytest.approx(depth * scale)
        return
    with pytest.raises(ValueError, match=said):
        to_metres(numbers, scale, "camera.json")


def test_an_image_without_depth_is_told():
    for empty in (np.zeros((3, 4), np.uint16), np.full((3, 4), np.nan)):
        with pytest.raises(ValueError, match="no depth"):
            to_metres(empty, None, "camera.json")


def test_colour_is_not_depth(tmp_path):
    Image.new("RGB", (4, 3)).save(tmp_path / "rgb.png")
    assert not is_depth(tmp_path / "rgb.png")
    with pytest.raises(ValueError, match="16 bits"):
        read_depth(tmp_path / "rgb.png")
