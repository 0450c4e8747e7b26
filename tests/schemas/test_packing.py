import gzip

import pytest

from semmap.schemas import packing
from semmap.schemas.errors import BadFile

TEXT = b":cup1 a dm:Cup .\n" * 1000


def test_what_is_small_travels_as_it_is():
    assert packing.packed(TEXT) is TEXT
    assert packing.unpacked(TEXT, "map.ttl") is TEXT


def test_what_is_large_is_packed_and_comes_back(monkeypatch):
    monkeypatch.setattr(packing, "PACKED_FROM", 1000)
    packed = packing.packed(TEXT)
    assert len(packed) < len(TEXT) / 10
    assert packing.unpacked(packed, "map.ttl") == TEXT
    assert packing.packed(packed) is packed


def test_a_file_packed_by_others_is_unpacked():
    several = gzip.compress(TEXT) + gzip.compress(b"# more\n") + b"\0" * 100
    assert packing.unpacked(several, "map.ttl.gz") == TEXT + b"# more\n"
    assert packing.beginning(several, 20, "map.ttl.gz") == TEXT[:20]
    assert packing.beginning(TEXT, 20, "map.ttl") == TEXT[:20]


@pytest.mark.parametrize(
    ("content", "text"),
    [
        (gzip.compress(TEXT)[:-20], "map.ttl.gz: the gzip data is truncated"),
        (gzip.compress(TEXT)[:10] + b"\xff" * 40, "map.ttl.gz: cannot decompress: .*invalid"),
        (b"\x1f\x8bnot at all", "map.ttl.gz: cannot decompress: .*unknown compression method"),
        (gzip.compress(b"0" * 30_000), "map.ttl.gz: decompressed size exceeds 0 MiB"),
        (gzip.compress(b"0" * 9_000) * 3, "map.ttl.gz: decompressed size exceeds 0 MiB"),
    ],
    ids=["cut", "damaged", "no gzip", "a bomb", "a bomb in pieces"],
)
def test_what_cannot_be_unpacked_is_refused(monkeypatch, content, text):
    monkeypatch.setattr(packing, "LARGEST", 20_000)
    with pytest.raises(BadFile, match=text):
        packing.unpacked(content, "map.ttl.gz")


def test_one_in_a_great_many_pieces_is_refused_before_they_take_long():
    with pytest.raises(BadFile, match="more than 1,000 gzip members"):
        packing.unpacked(gzip.compress(b"") * 100_000, "bomb.gz")


def test_little_does_not_become_very_much():
    with pytest.raises(BadFile, match=r"decompressed size exceeds 2\d MiB"):
        packing.unpacked(gzip.compress(b"0" * (32 << 20)), "bomb.gz")
