"""Large bodies are compressed on disk, and damaged ones are reported."""

import zlib

import msgpack
import pytest

from semmap.nodes.kb_node.storage.encoding import body_encoding
from semmap.schemas import codec, errors
from semmap.schemas.commits import Departed


def test_large_bodies_are_compressed():
    body = Departed(name="chair1", types=("Chair",) * 1000)
    small = body_encoding.encode(body, compressed_from=1000)
    assert len(small) < 100
    assert body_encoding.decode(small, Departed) == body_encoding.decode(codec.encode(body), Departed) == body
    assert msgpack.unpackb(zlib.decompress(small)) == {"name": "chair1", "types": ["Chair"] * 1000}
    assert body_encoding.encode(body, compressed_from=100_000) == codec.encode(body)


@pytest.mark.parametrize(
    ("body", "text"),
    [
        (b"x", "it ends too early"),
        (b"x\x9cnothing", "it is not valid MessagePack"),
        (zlib.compress(b"\x80")[:-3], "it ends too early"),
        (zlib.compress(b"\xc1" * 10_000), "it is not valid MessagePack"),
    ],
)
def test_invalid_compressed_data_is_malformed(body, text):
    with pytest.raises(errors.BadRequest, match=text):
        body_encoding.decode(body, Departed)


@pytest.mark.parametrize("compressed_from", [0, 1 << 20])
def test_names_are_found_in_a_body_without_decoding_it(monkeypatch, compressed_from):
    monkeypatch.setattr(body_encoding, "_PIECE", 10)
    body = body_encoding.encode(
        Departed(name="chair1", types=("Table", "Kitchen")), compressed_from=compressed_from
    )
    wanted = {b"chair1", b"Table", b"Kitchen", b"Cup"}
    assert body_encoding.find_contained(body, wanted) == wanted - {b"Cup"}


def test_a_decompression_bomb_is_rejected(monkeypatch):
    monkeypatch.setattr(body_encoding, "LARGEST", 1000)
    with pytest.raises(errors.BadRequest, match="larger than 0 MB"):
        body_encoding.decode(zlib.compress(bytes(2000)), Departed)
