"""Clouds in the formats of files."""

from __future__ import annotations

import struct

import numpy as np

COLORS = np.array([[255, 0, 0], [0, 255, 0], [0, 0, 255]] * 4, np.uint8)
POINTS = np.column_stack([np.arange(12) / 10, np.full(12, 0.5), np.full(12, 1.0)]).astype(np.float32)
POINTS[3] = np.nan


def header(encoding: str, *, width: int = 4, height: int = 3, fields: str = "label x y z rgba") -> bytes:
    kinds = {"label": "U", "rgba": "U"}
    names = fields.split()
    return (
        "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n"
        f"FIELDS {fields}\nSIZE {' '.join('4' for _ in names)}\n"
        f"TYPE {' '.join(kinds.get(name, 'F') for name in names)}\nCOUNT {' '.join('1' for _ in names)}\n"
        f"WIDTH {width}\nHEIGHT {height}\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {width * height}\nDATA {encoding}\n"
    ).encode()


def packed_colors() -> np.ndarray:
    r, g, b = COLORS.astype(np.uint32).T
    return (r << 16 | g << 8 | b).astype(np.uint32)


def pcd(encoding: str) -> bytes:
    """Return an organised cloud of 4 x 3 points with labels and colours."""
    label = np.arange(12, dtype=np.uint32)
    columns = [label, *POINTS.T, packed_colors()]
    if encoding == "ascii":
        lines = [" ".join(str(value) for value in row) for row in zip(*columns, strict=True)]
        return header(encoding) + "\n".join(lines).encode() + b"\n"
    if encoding == "binary":
        row = [("label", "u4"), ("x", "f4"), ("y", "f4"), ("z", "f4"), ("rgba", "u4")]
        return header(encoding) + np.rec.fromarrays(columns, dtype=row).tobytes()
    raw = b"".join(np.ascontiguousarray(column).tobytes() for column in columns)
    literal = b"".join(
        bytes([len(part) - 1]) + part for part in (raw[i : i + 32] for i in range(0, len(raw), 32))
    )
    return header(encoding) + struct.pack("<II", len(literal), len(raw)) + literal


def ply(encoding: str) -> bytes:
    order = ">" if encoding == "binary_big_endian" else "<"
    head = (
        f"ply\nformat {encoding} 1.0\ncomment made\nelement vertex 12\n"
        "property float x\nproperty float y\nproperty double z\n"
        "property uchar red\nproperty uchar green\nproperty uchar blue\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    ).encode()
    if encoding == "ascii":
        rows = [" ".join(map(str, (*point, *color))) for point, color in zip(POINTS, COLORS, strict=True)]
        return head + "\n".join(rows).encode() + b"\n3 0 1 2\n"
    row = [(name, order + kind) for name, kind in zip(("x", "y", "z"), ("f4", "f4", "f8"), strict=True)]
    row += [(name, "u1") for name in ("red", "green", "blue")]
    return head + np.rec.fromarrays([*POINTS.T, *COLORS.T], dtype=row).tobytes()
