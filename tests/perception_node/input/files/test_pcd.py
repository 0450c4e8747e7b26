"""PCD files: their headers and their points."""

import struct

import numpy as np
import pytest

from semmap.nodes.perception_node.input.files.columns import OtherVariant
from semmap.nodes.perception_node.input.files.pcd import decode, read_columns, read_header

LINES = {
    "VERSION": "0.7",
    "FIELDS": "x y z _ label",
    "SIZE": "4 4 4 1 2",
    "TYPE": "F F F U U",
    "COUNT": "1 1 1 2 1",
    "WIDTH": "2",
    "HEIGHT": "1",
    "POINTS": "2",
    "DATA": "ascii",
}
POINTS = [(0.1, 0.2, 1.0, (8, 9), 300), (0.3, 0.4, 2.0, (8, 9), 7)]
ROW = np.dtype([("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("_", "u1", (2,)), ("label", "<u2")])
ROWS = np.array(POINTS, ROW)


def header(without=(), **changes):
    lines = {key: value for key, value in (LINES | changes).items() if key not in without}
    return "# .PCD\n" + "".join(f"{key} {value}\n" for key, value in lines.items())


def packed(raw):
    """Compress with literal runs only."""
    runs = [raw[n : n + 32] for n in range(0, len(raw), 32)]
    body = b"".join(bytes([len(run) - 1]) + run for run in runs)
    return struct.pack("<II", len(body), len(raw)) + body


BODIES = {
    "ascii": b"0.1 0.2 1 8 9 300\n0.3 0.4 2 8 9 7\n",
    "binary": ROWS.tobytes(),
    "binary_compressed": packed(b"".join(ROWS[name].tobytes() for name in ROW.names)),
}


@pytest.mark.parametrize("encoding", BODIES)
def test_points_are_read_however_they_are_encoded(encoding):
    data = header(DATA=encoding).encode() + BODIES[encoding]
    said, start = read_header(data)
    assert (said.width, said.height, said.points, said.encoding) == (2, 1, 2, encoding)
    columns = read_columns(said, data[start:])
    assert columns.keys() == {"x", "y", "z", "label"}
    assert columns["x"].tolist() == pytest.approx([0.1, 0.3])
    assert columns["z"].tolist() == pytest.approx([1.0, 2.0])
    assert columns["label"].tolist() == [300, 7]
    assert decode(data).points_camera == pytest.approx(np.array([[(0.1, 0.2, 1.0), (0.3, 0.4, 2.0)]]))


@pytest.mark.parametrize("encoding", BODIES)
def test_a_body_that_ends_early_is_told(encoding):
    data = header(DATA=encoding).encode() + BODIES[encoding]
    with pytest.raises(ValueError, match="truncated"):
        decode(data[:-3])


def test_compressed_points_must_be_as_many_as_the_header_says_and_have_their_lengths():
    head = header(DATA="binary_compressed").encode()
    with pytest.raises(ValueError, match="truncated: no compressed points"):
        decode(head + b"1234567")
    with pytest.raises(ValueError, match="10 bytes of compressed points do not fit its header"):
        decode(head + struct.pack("<II", 4, 10))
    with pytest.raises(ValueError, match=r"truncated: 1 of \d+ bytes of compressed points"):
        decode(head + BODIES["binary_compressed"][:9])


def test_how_much_is_there_is_told_in_points():
    with pytest.raises(ValueError, match="truncated: 1 of 2 points"):
        decode(header(DATA="binary").encode() + BODIES["binary"][:-1])


def test_a_picture_s_rows_and_columns_are_kept_and_a_height_that_is_not_said_is_one():
    ascii_ = BODIES["ascii"]
    assert decode(header(WIDTH="1", HEIGHT="2").encode() + ascii_).points_camera.shape == (2, 1, 3)
    assert decode(header(without=["HEIGHT"]).encode() + ascii_).points_camera.shape == (1, 2, 3)


def test_counts_that_are_not_said_are_one():
    fields = {"FIELDS": "x y z", "SIZE": "4 4 4", "TYPE": "F F F"}
    data = header(without=["COUNT"], **fields).encode() + b"1 2 3\n4 5 6\n"
    assert read_header(data)[0].fields == tuple((name, np.dtype("f4"), 1) for name in "xyz")


@pytest.mark.parametrize(
    ("changes", "without", "why"),
    [
        ({}, ["DATA"], "no DATA line"),
        ({"TYPE": "F F F U X"}, [], "its header is damaged"),
        ({"SIZE": "4 4 4 1"}, [], "its header is damaged"),
        ({"COUNT": "1 1 1 2"}, [], "its header is damaged"),
        ({}, ["TYPE"], "its header is damaged"),
        ({"WIDTH": "two"}, [], "its header is damaged"),
        ({"WIDTH": "-1"}, [], "its header declares -1 x 1 points"),
        ({"HEIGHT": "-2"}, [], "its header declares 2 x -2 points"),
        ({"WIDTH": "10000", "HEIGHT": "5001"}, [], "declares 10000 x 5001 points"),
        ({"COUNT": "1 1 1 0 1"}, [], "its header declares"),
        ({"DATA": "gzip"}, [], "encoded as 'gzip', not ascii, binary"),
    ],
)
def test_what_is_wrong_with_a_header_is_told(changes, without, why):
    with pytest.raises(ValueError, match=why):
        decode(header(without, **changes).encode() + BODIES["ascii"])


@pytest.mark.parametrize("old", [header(without=["WIDTH"]), header().replace("FIELDS", "COLUMNS")])
def test_a_header_of_an_old_version_is_told_apart(old):
    with pytest.raises(OtherVariant):
        decode(old.encode() + BODIES["ascii"])


def test_a_data_line_that_never_ends_or_comes_too_late_is_none():
    with pytest.raises(ValueError, match="no DATA line"):
        read_header(b"FIELDS x\nDATA ascii")
    with pytest.raises(ValueError, match="no DATA line"):
        read_header(b"#" * 5000 + b"\nDATA ascii\n")
