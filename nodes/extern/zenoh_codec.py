"""Codecs for the zenoh CLI: `zenoh put --encoder msgpack`, `zenoh get --decoder msgpack`.

A value is JSON on the command line and MessagePack on the wire.
"""

from __future__ import annotations

import json

import msgspec

from schemas import codec


def encode(key: str, value: str) -> bytes:
    """JSON text as MessagePack. Raises ValueError when `value` is no JSON."""
    return msgspec.msgpack.encode(json.loads(value))


def decode(key: str, value: bytes) -> str:
    """MessagePack (or JSON, which some replies are) as JSON text on one line."""
    if not value:
        return ""
    if codec.looks_like_json(value) or value[:1] == b"[":
        return json.dumps(json.loads(value))
    return msgspec.json.encode(msgspec.msgpack.decode(value)).decode()
