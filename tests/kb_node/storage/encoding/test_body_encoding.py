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


def test_a_decompression_bomb_is_rejected(monkeypatch):
    monkeypatch.setattr(body_encoding, "LARGEST", 1000)
    with pytest.raises(errors.BadRequest, match="larger than 0 MB"):
        body_encoding.decode(zlib.compress(bytes(2000)), Departed)
