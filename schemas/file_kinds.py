"""Recognises files that cannot be maps by their first bytes."""

from __future__ import annotations

from typing import Final

_KINDS: Final = (
    (b"%PDF-", "a PDF document"),
    (b"PK\x03\x04", "a ZIP archive (or an office document)"),
    (b"\x7fELF", "a program"),
    (b"MZ", "a program"),
    (b"\x89PNG", "an image"),
    (b"\xff\xd8\xff", "an image"),
    (b"GIF8", "an image"),
    (b"SQLite format 3", "a database"),
    (b"RRF2", "a recording; open it with `semmap replay`"),
    (b"#ROSBAG", "a recording; convert it with `semmap frames`"),
    (b"\x89MCAP", "a recording; convert it with `semmap frames`"),
    (b"\x93NUMPY", "a NumPy array"),
    (b"glTF", "a 3-D model"),
)


def other_kind(beginning: bytes) -> str:
    """Return what a file is that cannot be a map, such as `an image`, or an empty text."""
    return next((kind for magic, kind in _KINDS if beginning.startswith(magic)), "")
