"""Codecs for the zenoh CLI: `zenoh put --encoder msgpack`, `zenoh get --decoder msgpack`.

A value is JSON on the command line and MessagePack on the wire. The package `msgpack` is used instead of the
library of the nodes, which shows that any MessagePack library is compatible.
"""

from __future__ import annotations

import base64
import json

import msgpack


def encode(key: str, value: str) -> bytes:
    """Convert JSON text to MessagePack. Raises ValueError if `value` is not JSON."""
    packed: bytes = msgpack.packb(json.loads(value))
    return packed


def decode(key: str, value: bytes) -> str:
    """Convert MessagePack or JSON to JSON text on one line, with bytes as base64."""
    if not value:
        return ""
    if value.lstrip()[:1] in (b"{", b"["):
        return json.dumps(json.loads(value))
    return json.dumps(msgpack.unpackb(value, strict_map_key=False), default=_base64)


def _base64(content: bytes) -> str:
    return base64.b64encode(content).decode()
