import io

import numpy as np
import pytest
from PIL import Image

from semmap.nodes.navigation.grid import FREE, OCCUPIED, UNKNOWN, Frame, OccupancyGrid
from semmap.nodes.navigation.map_server import grid_of, pgm, pixels_of, png, read_image, read_yaml, yaml_of
from semmap.schemas.errors import BadFile

FRAME = Frame(-0.6, 1.25, 0.05, 3, 2)
GRID = OccupancyGrid(FRAME, np.array([[FREE, OCCUPIED, UNKNOWN], [UNKNOWN, UNKNOWN, FREE]], dtype=np.int8))


def decoded(content):
    return np.asarray(Image.open(io.BytesIO(content)).convert("L"))


def test_what_is_written_is_read_the_same():
    for encode in (png, pgm):
        pixels = read_image(encode(pixels_of(GRID)), "plan", decoded)
        described = read_yaml(yaml_of("plan.png", FRAME), "plan.yaml")
        assert (described.image, described.resolution, described.origin) == (
            "plan.png",
            0.05,
            (-0.6, 1.25, 0.0),
        )
        assert (grid_of(described, pixels).cells == GRID.cells).all()


def test_the_image_is_what_others_expect():
    image = Image.open(io.BytesIO(png(pixels_of(GRID))))

    assert (image.size, image.mode) == ((3, 2), "L")
    assert np.asarray(image).tolist() == [[205, 205, 254], [254, 0, 205]]


def test_pgm_in_text_with_comments_and_sixteen_bits():
    text = b"P2\n# made by hand\n2 1\n# brightest\n100\n0 100\n"
    assert read_image(text, "plan.pgm", decoded).tolist() == [[0, 255]]
    wide = b"P5 2 1 65535\n" + bytes([0, 0, 255, 255])
    assert read_image(wide, "plan.pgm", decoded).tolist() == [[0, 255]]


def test_negate_raw_and_lists_over_lines():
    said = "image: 'a b.pgm'  # with a space\nresolution: 0.1\norigin:\n - 1\n - 2\n - 0.5\nnegate: 1\n"
    described = read_yaml(said, "m.yaml")
    assert (described.image, described.origin) == ("a b.pgm", (1.0, 2.0, 0.5))
    assert grid_of(described, np.array([[0, 255]], dtype=np.uint8)).cells.tolist() == [[FREE, OCCUPIED]]
    raw = read_yaml("image: x\nresolution: 1\nmode: raw\n", "m.yaml")
    pixels = np.array([[0, 100, 255]], dtype=np.uint8)
    assert grid_of(raw, pixels).cells.tolist() == [[FREE, OCCUPIED, UNKNOWN]]


@pytest.mark.parametrize(
    ("values", "mode", "expected"),
    [
        ((0, 205, 254), "trinary", UNKNOWN),  # map_saver's default threshold makes it free
        ((0, 205, 254), "scale", FREE),
        ((0, 205, 250), "trinary", FREE),
        ((0, 205, 254, 255), "trinary", FREE),
        ((0, 205), "trinary", FREE),
    ],
)
def test_grey_is_unknown_in_an_image_of_the_map_saver(values, mode, expected):
    described = read_yaml(f"image: x\nresolution: 1\nmode: {mode}\nfree_thresh: 0.25\n", "m.yaml")
    cells = grid_of(described, np.array([values], dtype=np.uint8)).cells
    assert cells[0, 1] == expected
    assert cells[0, 0] == OCCUPIED


def test_grey_of_a_negated_image_is_what_its_thresholds_say():
    described = read_yaml("image: x\nresolution: 1\nnegate: 1\nfree_thresh: 0.25\n", "m.yaml")
    assert grid_of(described, np.array([[0, 205, 254]], dtype=np.uint8)).cells[0, 1] == OCCUPIED


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("resolution: 0.05\n", "requires image: FILE and resolution: METRES"),
        ("hello\n", "invalid line 'hello'"),
        ("image: x\nresolution: nan\n", "resolution 'nan' is not a number"),
        ("image: x\nresolution: 0\n", "metres per pixel, above 0 and up to"),
        ("image: x\nresolution: 0.1\norigin: [1]\n", "it must be .x, y, yaw."),
        ("image: x\nresolution: 0.1\norigin: [a, b, c]\n", "it must be .x, y, yaw."),
        ("image: x\nresolution: 0.1\nmode: odd\n", "invalid mode 'odd'"),
        ("image: x\nresolution: 0.1\nfree_thresh: 0.9\n", "below occupied_thresh"),
    ],
)
def test_broken_descriptions(text, said):
    with pytest.raises(BadFile, match=said):
        read_yaml(text, "plan.yaml")


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"GIF89a", "not a PNG or PGM image"),
        (b"P5\n2 2\n", "invalid header"),
        (b"P5\n2 2\n255\nab", "is truncated"),
        (b"P2\n2 2\n255\n1 2 x 4", "is truncated"),
        (b"P5\n90000 90000\n255\n", "has at most"),
    ],
)
def test_broken_images(content, said):
    with pytest.raises(BadFile, match=said):
        read_image(content, "plan.pgm", decoded)
