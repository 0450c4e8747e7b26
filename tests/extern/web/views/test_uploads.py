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
def test_what_may_be_a_map_is_let_through(beginning):
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
def test_what_cannot_be_one_is_refused_with_what_it_is(beginning, says):
    sentence = check_upload("thing.bin", 1000, beginning)
    assert says in sentence
    assert sentence.startswith("thing.bin: ")


def test_sizes():
    assert check_upload("empty.ttl", 0, b"") == "empty.ttl: the file is empty"
    assert "larger than 200 MB" in check_upload("big.ttl", LARGEST + 1, b"")
    assert megabytes(50 << 20) == "50 MB"
    assert megabytes(1_600_000) == "1.5 MB"
    assert megabytes(2048) == "2 KB"


def test_spatial_roots_are_written_with_commas_or_spaces():
    assert spatial_roots("Thing, http://x.org/a#Place  Thing") == ("Thing", "http://x.org/a#Place")
    assert spatial_roots(None) == ()
