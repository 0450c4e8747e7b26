from __future__ import annotations

import json

import msgpack
import pytest

from semmap.nodes.extern.zenoh_codec import decode, encode


def test_json_on_the_command_line_is_messagepack_on_the_wire():
    value = {"class": "Chair", "at": [1, 2.5, 0], "ref": "sedia è"}
    assert msgpack.unpackb(encode("semmap/cmd/add", json.dumps(value))) == value
    assert json.loads(decode("semmap/cmd/add", encode("k", json.dumps(value)))) == value


def test_a_reply_in_json_is_shown_as_it_is():
    assert json.loads(decode("k", b'{"name": "chair1"}')) == {"name": "chair1"}
    assert json.loads(decode("k", b'[{"name": "chair1"}]')) == [{"name": "chair1"}]


def test_other_texts_than_json_cannot_be_encoded():
    with pytest.raises(ValueError, match="Expecting"):
        encode("k", "not json")
