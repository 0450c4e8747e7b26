"""PLY files: their headers and their vertices."""

import numpy as np
import pytest

from semmap.nodes.perception_node.input.files.columns import OtherVariant
from semmap.nodes.perception_node.input.files.ply import decode

POINTS = np.array([(0.1, 0.2, 1.0, 255), (0.3, 0.4, 2.0, 7)])
ROW = [("x", "f4"), ("y", "f8"), ("z", "f4"), ("red", "u1"), ("green", "u1"), ("blue", "u1")]
TYPES = {"f4": "float", "f8": "double", "u1": "uchar"}


def header(encoding="ascii", count=2, before="", after="", properties=ROW):
    listed = "".join(f"property {TYPES.get(kind, kind)} {name}\n" for name, kind in properties)
    return (
        f"ply\nformat {encoding} 1.0\ncomment made\n{before}"
        f"element vertex {count}\n{listed}{after}end_header\n"
    ).encode()


def rows(order):
    row = np.dtype([(name, order + kind) for name, kind in ROW])
    return np.array([(x, y, z, red, 0, 0) for x, y, z, red in POINTS], row).tobytes()


ASCII = b"0.1 0.2 1 255 0 0\n0.3 0.4 2 7 0 0\n"
BODIES = {"ascii": ASCII, "binary_little_endian": rows("<"), "binary_big_endian": rows(">")}


@pytest.mark.parametrize("encoding", BODIES)
def test_vertices_are_read_however_they_are_encoded(encoding):
    cloud = decode(header(encoding) + BODIES[encoding])
    assert cloud.points_camera.shape == (1, 2, 3)
    assert cloud.points_camera[0] == pytest.approx(POINTS[:, :3])
    assert cloud.colors[0].tolist() == [[255, 0, 0], [7, 0, 0]]


def test_what_comes_after_the_vertices_is_passed_over():
    after = "element face 1\nproperty list uchar int vertex_indices\n"
    cloud = decode(header(after=after) + BODIES["ascii"] + b"3 0 1 0\n")
    assert cloud.points_camera.shape == (1, 2, 3)


@pytest.mark.parametrize(
    ("how", "why"),
    [
        ({"encoding": "utf8"}, "its format is 'utf8', not ascii, binary_little_endian or binary_big_endian"),
        ({"properties": []}, "declares 2 points with 0 properties"),
        ({"count": -1}, "declares -1 points"),
        ({"count": 50_000_001}, "declares 50000001 points"),
        ({"properties": [("x", "quad")]}, "its property x is of the unknown type 'quad'"),
        ({"count": 3}, "truncated: 2 of 3 points"),
        ({"count": 9, "encoding": "binary_little_endian"}, "truncated: 1 of 9 points"),
    ],
    ids=str,
)
def test_what_is_wrong_is_told(how, why):
    with pytest.raises(ValueError, match=why):
        decode(header(**how) + BODIES["ascii"])


@pytest.mark.parametrize(
    "how",
    [
        {"before": "element camera 1\nproperty float x\n"},
        {"after": "property list uchar int neighbours\n"},
    ],
    ids=["another element first", "lists"],
)
def test_files_of_another_sort_are_told_apart(how):
    with pytest.raises(OtherVariant):
        decode(header(**how) + BODIES["ascii"])


def test_a_header_that_never_ends_is_told():
    for data in (b"ply\nformat ascii 1.0\n", header()[:-1], b"#" * 20_000 + header()):
        with pytest.raises(ValueError, match="no end_header"):
            decode(data)
