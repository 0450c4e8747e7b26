import gzip

import pytest

from semmap.nodes.extern.web.views.uploads import LARGEST, check_upload, megabytes, spatial_roots


@pytest.mark.parametrize(
    "beginning",
    [
        b"@prefix : <http://x#> .",
        b'{"entities": []}',
        b"\xef\xbb\xbf<?xml",
        gzip.compress(b"@prefix", mtime=0),
    ],
)
def test_possible_maps_are_accepted(beginning):
    assert check_upload("flat.ttl", 50 << 20, beginning) == ""


@pytest.mark.parametrize(
    ("beginning", "says"),
    [
        (b"%PDF-1.7", "is a PDF document"),
        (b"PK\x03\x04...", "is a ZIP archive"),
        (b"\x89PNG\r\n", "is an image"),
        (b"RRF2\0\0", "is a recording; open it with `semmap replay`"),
        (b"abc\0def", "unsupported binary format"),
    ],
)
def test_other_formats_are_rejected_by_their_magic_bytes(beginning, says):
    sentence = check_upload("thing.bin", 1000, beginning)
    assert says in sentence
    assert sentence.startswith("thing.bin: ")


def test_sizes_are_checked_and_formatted():
    assert check_upload("empty.ttl", 0, b"") == "empty.ttl: the file is empty"
    assert "larger than 200 MB" in check_upload("big.ttl", LARGEST + 1, b"")
    assert megabytes(50 << 20) == "50 MB"
    assert megabytes(1_600_000) == "1.5 MB"
    assert megabytes(2048) == "2 KB"


def test_spatial_roots_are_separated_by_commas_or_spaces():
    assert spatial_roots("Thing, http://x.org/a#Place  Thing") == ("Thing", "http://x.org/a#Place")
    assert spatial_roots(None) == ()
