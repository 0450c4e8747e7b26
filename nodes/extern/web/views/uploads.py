"""What may be uploaded, decided before any of it is sent on: by its size and by how it begins."""

from __future__ import annotations

from typing import Final

from semmap.schemas.packing import PACKED_FROM

LARGEST: Final = 200 << 20
"""Bytes; what is larger is loaded with the command line, from a file."""
BEGINNING: Final = 4096
"""Bytes that are looked at."""

_KINDS: Final = (
    (b"%PDF-", "a PDF document"),
    (b"PK\x03\x04", "a ZIP archive (or an office document)"),
    (b"\x7fELF", "a program"),
    (b"MZ", "a program"),
    (b"\x89PNG", "a picture"),
    (b"\xff\xd8\xff", "a picture"),
    (b"GIF8", "a picture"),
    (b"SQLite format 3", "a database"),
    (b"RRF2", "a recording; open it with: semmap replay"),
    (b"glTF", "a 3-D model"),
)
_GZIP: Final = b"\x1f\x8b"
READS: Final = (
    "RDF in any syntax, OWL (functional, Manchester or XML), a scene in JSON or a HuRIC map, "
    "also packed with gzip"
)


def refusal(filename: str, size: int, beginning: bytes) -> str:
    """Why a file cannot be loaded, in one sentence; empty for one that may be what `READS` says."""
    if size == 0:
        return f"{filename} is empty"
    if size > LARGEST:
        return too_large(filename, size)
    for magic, kind in _KINDS:
        if beginning.startswith(magic):
            return f"{filename} is {kind}; what can be loaded is {READS}"
    if b"\0" in beginning and not beginning.startswith((_GZIP, b"\xff\xfe", b"\xfe\xff")):
        return f"{filename} is not text; what can be loaded is {READS}"
    return ""


def too_large(filename: str, size: int) -> str:
    """That a file is larger than the page takes."""
    return (
        f"{filename} has {megabytes(size)}, and the page takes up to {megabytes(LARGEST)}; "
        "load larger files with: semmap load FILE"
    )


def megabytes(size: int) -> str:
    """A number of bytes as people say it."""
    return f"{size / 1024:.0f} KB" if size < 1 << 20 else f"{size / (1 << 20):.1f} MB".replace(".0 ", " ")


def takes_long(size: int) -> bool:
    """Is the file so large that it may take more than moments?"""
    return size > PACKED_FROM // 8


def spatial_roots(words: str | None) -> tuple[str, ...]:
    """The classes that are written with commas or spaces between them, by name or IRI, each once."""
    return tuple(dict.fromkeys((words or "").replace(",", " ").split()))
