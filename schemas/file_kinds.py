"""Recognises files that cannot be maps by their first bytes."""

from __future__ import annotations

import re
from typing import Final

FORMATS: Final = (
    "RDF in any syntax, OWL (functional, Manchester or XML), a scene in JSON or a HuRIC map, "
    "optionally compressed with gzip"
)
"""The formats of maps."""

_KINDS: Final = (
    (b"%PDF-", "a PDF document"),
    (b"PK\x03\x04", "a ZIP archive (or an office document)"),
    (b"\x7fELF", "a program"),
    (b"MZ", "a program"),
    (b"\x89PNG", _IMAGE := "an image; a floor plan is loaded by its .yaml file"),
    (b"\xff\xd8\xff", _IMAGE),
    (b"GIF8", _IMAGE),
    (b"SQLite format 3", "a database"),
    (b"RRF2", "a recording; open it with `semmap replay`"),
    (b"#ROSBAG", "a recording; convert it with `semmap frames`"),
    (b"\x89MCAP", "a recording; convert it with `semmap frames`"),
    (b"\x93NUMPY", "a NumPy array"),
    (b"glTF", "a 3-D model"),
)


_WORLD: Final = re.compile(rb"(?:\s|<\?.*?\?>|<!--.*?-->)*<mujoco\b", re.DOTALL)


def other_kind(beginning: bytes) -> str:
    """Return what a file is that cannot be a map, with the next step, or an empty text."""
    if _WORLD.match(beginning):
        return "a world; start a system with it: `semmap up --world FILE`"
    kind = next((kind for magic, kind in _KINDS if beginning.startswith(magic)), "")
    return kind if not kind or ";" in kind else f"{kind}; supported formats: {FORMATS}"
