"""Images of other people are checked before they are decoded."""

from __future__ import annotations

import struct
import zlib

import numpy as np
import pytest
from PIL import Image

from semmap.nodes.runtime import pictures
from semmap.nodes.runtime.pictures import open_picture, require_small_png

WIDTH, HEIGHT = 40, 30


@pytest.fixture
def picture(tmp_path):
    path = tmp_path / "picture.png"
    Image.fromarray(np.zeros((HEIGHT, WIDTH, 3), np.uint8)).save(path)
    return path


def png_of(width, height):
    """Return a small PNG file that claims a size."""

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    return (
        b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(b"")) + chunk(b"IEND", b"")
    )


def test_a_picture_is_read_from_a_file_or_its_content(picture):
    assert open_picture(picture).size == open_picture(picture.read_bytes()).size == (WIDTH, HEIGHT)
    require_small_png(picture)


@pytest.mark.parametrize("size", [60, 20, 4, 0])
def test_a_truncated_picture_is_invalid(picture, size):
    with pytest.raises(ValueError, match="not an image"):
        open_picture(picture.read_bytes()[:size])
    picture.write_bytes(picture.read_bytes()[:size])
    require_small_png(picture)


def test_text_and_programs_are_not_images(tmp_path):
    for content in (
        b"nothing to see",
        b"%!PS-Adobe-3.0 EPSF-3.0\n%%BoundingBox: 0 0 9 9\n%%EndComments\nshowpage\n",
    ):
        with pytest.raises(ValueError, match="not an image"):
            open_picture(content)
    with pytest.raises(FileNotFoundError):
        open_picture(tmp_path / "nothing.png")


@pytest.mark.parametrize(
    ("width", "height"), [(10_000, 5_001), (13_000, 13_000), (30_000, 30_000), (2**31 - 1,) * 2]
)
def test_too_many_pixels_are_rejected_before_they_are_decoded(tmp_path, width, height):
    with pytest.raises(ValueError, match=r"pixels; the maximum is 50,000,000"):
        open_picture(png_of(width, height))
    path = tmp_path / "large.png"
    path.write_bytes(png_of(width, height))
    with pytest.raises(ValueError, match=f"has {width} x {height} pixels; the maximum is 50,000,000 pixels"):
        require_small_png(path)


def test_the_limit_can_be_lower(picture):
    with pytest.raises(ValueError, match="has 40 x 30 pixels; the maximum is 1,199 pixels"):
        open_picture(picture, WIDTH * HEIGHT - 1)
    assert open_picture(picture, WIDTH * HEIGHT).size == (WIDTH, HEIGHT)


def test_other_libraries_are_limited_as_well(tmp_path):
    assert pictures.MAX_PIXELS == 2 * Image.MAX_IMAGE_PIXELS
    path = tmp_path / "large.png"
    path.write_bytes(png_of(10_000, 5_001))
    with pytest.raises(Image.DecompressionBombError):
        Image.open(path)
