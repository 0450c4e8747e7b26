"""PCD files: text, binary or compressed, with any fields."""

from __future__ import annotations

import struct
from dataclasses import dataclass

import numpy as np

from semmap.nodes.perception_node.input.cloud import Cloud
from semmap.nodes.perception_node.input.files import lzf
from semmap.nodes.perception_node.input.files.columns import (
    MAX_POINTS,
    Column,
    Field,
    OtherVariant,
    cloud_of,
    columns_of_text,
)
from semmap.nodes.perception_node.input.viewpoint import Placement

_KINDS = {"F": "f", "U": "u", "I": "i"}
_LONGEST_HEADER = 4096


@dataclass(frozen=True)
class Header:
    """The header of a PCD file."""

    fields: tuple[Field, ...]
    width: int
    height: int
    encoding: str

    @property
    def points(self) -> int:
        """Return the number of points, including NaN."""
        return self.width * self.height


def decode(data: bytes, placement: Placement | None = None) -> Cloud:
    """Return the cloud in a PCD file's bytes. Raises ValueError."""
    header, start = read_header(data)
    return cloud_of(read_columns(header, data[start:]), header.height, header.width, placement)


def read_header(data: bytes) -> tuple[Header, int]:
    """Return the header and the offset of the points. Raises ValueError; OtherVariant for an old version."""
    mark = data.find(b"\nDATA ", 0, _LONGEST_HEADER)
    end = data.find(b"\n", mark + 1)
    if mark < 0 or end < 0:
        raise ValueError("no DATA line in its header")
    lines = data[:end].decode("ascii", errors="replace").splitlines()
    entries = {
        words[0]: words[1:] for words in map(str.split, lines) if words and not words[0].startswith("#")
    }
    if "COLUMNS" in entries or (
        "FIELDS" in entries and "WIDTH" not in entries
    ):  # as it was before version .6
        raise OtherVariant("its header is of an old version")
    try:
        names, sizes, kinds = entries["FIELDS"], entries["SIZE"], entries["TYPE"]
        counts = [int(count) for count in entries.get("COUNT", ["1"] * len(names))]
        width, height = int(entries["WIDTH"][0]), int(entries.get("HEIGHT", ["1"])[0])
        dtypes = [np.dtype(_KINDS[kind] + size) for kind, size in zip(kinds, sizes, strict=True)]
        fields = tuple(zip(names, dtypes, counts, strict=True))
    except (KeyError, IndexError, TypeError, ValueError) as error:
        raise ValueError(f"its header is damaged ({error})") from None
    if width < 0 or height < 0 or width * height > MAX_POINTS or any(count < 1 for count in counts):
        raise ValueError(f"its header declares {width} x {height} points")
    return Header(fields, width, height, entries["DATA"][0]), end + 1


def read_columns(header: Header, body: bytes) -> dict[str, Column]:
    """Return each field with one element per point, (points,). Raises ValueError for a truncated body."""
    match header.encoding:
        case "ascii":
            return columns_of_text(body, header.fields, header.points)
        case "binary":
            return _of_rows(header, body)
        case "binary_compressed":
            return _of_packed(header, body)
        case other:
            raise ValueError(f"its points are encoded as '{other}', not ascii, binary or binary_compressed")


def _of_rows(header: Header, body: bytes) -> dict[str, Column]:
    # numbered, because padding fields may share one name
    row = np.dtype([(str(i), dtype, (count,)) for i, (_, dtype, count) in enumerate(header.fields)])
    if len(body) < header.points * row.itemsize:
        raise ValueError(f"truncated: {len(body) // row.itemsize} of {header.points} points")
    rows = np.frombuffer(body, row, header.points)
    return {name: rows[str(i)][:, 0] for i, (name, _, count) in enumerate(header.fields) if count == 1}


def _of_packed(header: Header, body: bytes) -> dict[str, Column]:
    if len(body) < 8:
        raise ValueError("truncated: no compressed points")
    packed, size = struct.unpack("<II", body[:8])
    if size != header.points * sum(dtype.itemsize * count for _, dtype, count in header.fields):
        raise ValueError(f"{size} bytes of compressed points do not fit its header")
    if len(body) < 8 + packed:
        raise ValueError(f"truncated: {len(body) - 8} of {packed} bytes of compressed points")
    raw = lzf.decompress(body[8 : 8 + packed], size)
    columns, place = {}, 0
    for name, dtype, count in header.fields:
        if count == 1:
            columns[name] = np.frombuffer(raw, dtype, header.points, place)
        place += dtype.itemsize * count * header.points
    return columns
