"""PLY files: the vertices, text or binary."""

from __future__ import annotations

import numpy as np

from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.input.files.columns import (
    MAX_POINTS,
    Column,
    OtherVariant,
    cloud_of,
    columns_of_text,
)
from semmap.nodes.perception_node.input.viewpoint import Placement

_TYPES = {
    **{"char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1"},
    **{"short": "i2", "int16": "i2", "ushort": "u2", "uint16": "u2"},
    **{"int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4"},
    **{"float": "f4", "float32": "f4", "double": "f8", "float64": "f8"},
}
_ORDERS = {"binary_little_endian": "<", "binary_big_endian": ">"}
_LONGEST_HEADER = 16384


def decode(data: bytes, placement: Placement | None = None) -> Cloud:
    """Return the vertices in a PLY file's bytes, in a single row.

    Raises ValueError, and OtherVariant if the vertices do not come first or have lists.
    """
    encoding, count, properties, start = _read_header(data)
    body = data[start:]
    if encoding == "ascii":
        fields = [(name, np.dtype(kind), 1) for name, kind in properties]
        return cloud_of(columns_of_text(body, fields, count), 1, count, placement)
    return cloud_of(_of_rows(body, count, properties), 1, count, placement)


def _read_header(data: bytes) -> tuple[str, int, list[tuple[str, str]], int]:
    """Return encoding, number of vertices, (name, dtype) of their properties, and the offset of the data."""
    mark = data.find(b"end_header", 0, _LONGEST_HEADER)
    end = data.find(b"\n", mark)
    if mark < 0 or end < 0:
        raise ValueError("no end_header line in its header")
    encoding, count, element = "", 0, ""
    properties: list[tuple[str, str]] = []
    for line in data[:mark].decode("ascii", errors="replace").splitlines():
        match line.split():
            case ["format", format_, *_]:
                encoding = format_
            case ["element", name, _] if not properties and name != "vertex":
                raise OtherVariant(f"its first element is '{name}', not vertex")
            case ["element", name, number]:
                element = name
                count = int(number) if name == "vertex" else count
            case ["property", "list", *_] if element == "vertex":
                raise OtherVariant("its vertices have list properties")
            case ["property", kind, name] if element == "vertex":
                if kind not in _TYPES:
                    raise ValueError(f"its property {name} is of the unknown type '{kind}'")
                properties.append((name, _ORDERS.get(encoding, "") + _TYPES[kind]))
    if encoding != "ascii" and encoding not in _ORDERS:
        raise ValueError(f"its format is '{encoding}', not ascii, {' or '.join(_ORDERS)}")
    if not 0 <= count <= MAX_POINTS or not properties:
        raise ValueError(f"its header declares {count} points with {len(properties)} properties")
    return encoding, count, properties, end + 1


def _of_rows(body: bytes, count: int, properties: list[tuple[str, str]]) -> dict[str, Column]:
    row = np.dtype(properties)
    if len(body) < count * row.itemsize:
        raise ValueError(f"truncated: {len(body) // row.itemsize} of {count} points")
    rows = np.frombuffer(body, row, count)
    return {name: rows[name].astype(row[name].newbyteorder("=")) for name, _ in properties}
