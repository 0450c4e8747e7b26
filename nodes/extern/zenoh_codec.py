"""Codecs for the zenoh CLI: `zenoh put --encoder msgpack`, `zenoh get --decoder msgpack`.

A value is JSON on the command line and MessagePack on the wire, which is plain: any library reads and writes
it, and here that is `msgpack`, not the one that the nodes use.
"""

from __future__ import annotations

import base64
import json

import msgpack


def encode(key: str, value: str) -> bytes:
    """JSON text as MessagePack. Raises ValueError when `value` is not JSON."""
    packed: bytes = msgpack.packb(json.loads(value))
    return packed


def decode(key: str, value: bytes) -> str:
    """MessagePack (or JSON, which some replies are) as JSON text on one line; bytes become base64."""
    if not value:
        return ""
    if value.lstrip()[:1] in (b"{", b"["):
        return json.dumps(json.loads(value))
    return json.dumps(msgpack.unpackb(value, strict_map_key=False), default=_base64)


def _base64(content: bytes) -> str:
    return base64.b64encode(content).decode()
