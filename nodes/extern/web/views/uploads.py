"""Checks of uploaded files by size and first bytes, before they are sent to the system."""

from __future__ import annotations

from typing import Final

from semmap.schemas.file_kinds import FORMATS, other_kind
from semmap.schemas.packing import PACKED_FROM

LARGEST: Final = 200 << 20
"""Maximum size [bytes]; larger files are loaded with the command line."""
BEGINNING: Final = 4096
"""Number of bytes that are checked."""

_GZIP: Final = b"\x1f\x8b"


def check_upload(filename: str, size: int, beginning: bytes) -> str:
    """Return the error text for a file that cannot be loaded; empty if it can be one of the `FORMATS`."""
    if size == 0:
        return f"{filename}: the file is empty"
    if size > LARGEST:
        return size_error(filename, size)
    if kind := other_kind(beginning):
        return f"{filename}: unsupported format, the file is {kind}"
    if b"\0" in beginning and not beginning.startswith((_GZIP, b"\xff\xfe", b"\xfe\xff")):
        return f"{filename}: unsupported binary format; supported formats: {FORMATS}"
    return ""


def size_error(filename: str, size: int | None = None) -> str:
    """Return the error text for an upload above the size limit."""
    actual = "" if size is None else f"{megabytes(size)} is "
    return f"{filename}: {actual}larger than {megabytes(LARGEST)}; load larger files with `semmap load FILE`"


def megabytes(size: int) -> str:
    """Return a number of bytes in KB or MB."""
    return f"{size / 1024:.0f} KB" if size < 1 << 20 else f"{size / (1 << 20):.1f} MB".replace(".0 ", " ")


def takes_long(size: int) -> bool:
    """Return whether loading a file of this size may take several seconds."""
    return size > PACKED_FROM // 8


def spatial_roots(words: str | None) -> tuple[str, ...]:
    """Return the classes in a list with commas or spaces, by name or IRI, each once."""
    return tuple(dict.fromkeys((words or "").replace(",", " ").split()))
