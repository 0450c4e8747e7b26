"""The file format of `semmap backup`: the rows of a journal, each with its digest.

A file consists of `MAGIC` and a sequence of frames: a length of 4 bytes (big-endian) and a message. A large
row is split into several consecutive pieces.
"""

from __future__ import annotations

import hashlib
from collections import deque
from collections.abc import Iterator
from contextlib import suppress
from datetime import datetime
from pathlib import Path
from typing import BinaryIO, Final, Literal

import msgspec
from msgspec import Struct

from semmap.schemas import codec, wording
from semmap.schemas.errors import BadFile

MAGIC: Final = b"semmap backup 1\n"
_LENGTH: Final = 4

Kind = Literal["tbox", "beginning", "snapshot", "commit", "checkpoint", "shapes"]
"""`shapes` is the file with the shapes of the bodies of world files, and its `seq` the time of that file."""


class Opening(Struct, frozen=True, kw_only=True, tag="opening"):
    """The header of a backup: the identity of the map, and its first and last commit."""

    map_id: str
    """The digest of the map's first commit, in hexadecimal."""
    begun_ns: int
    """The time of the map's first commit."""
    first: int
    """The first commit that is included and not only part of a snapshot."""
    last: int
    digest: str
    """The digest of all commits up to the last."""
    stamp_ns: int
    """The time of the last commit."""
    chain: bytes = b""
    """The digest of the history before the first commit."""


class Piece(Struct, frozen=True, kw_only=True, tag="piece", omit_defaults=True):
    """A part of a row's content; `more` says that another part follows."""

    kind: Kind
    seq: int
    id: str = ""
    digest: bytes
    content: bytes
    more: bool = False


class End(Struct, frozen=True, kw_only=True, tag="end"):
    """The end of the file, which shows that it is complete."""

    last: int


Frame = Opening | Piece | End
_encoder = msgspec.msgpack.Encoder()
_decoder = codec.decoder(Frame)


class Restored(Struct, frozen=True, kw_only=True):
    """A map that a backup was restored to."""

    opening: Opening
    """The header of the backup."""
    entities: int
    kept: str | None = None
    """The folder that the previous map was moved to, if there was one."""

    @property
    def text(self) -> str:
        """A summary in one sentence."""
        map_ = self.opening
        previous = "" if self.kept is None else f"; the previous map was moved to {self.kept}"
        return (
            f"map {map_.map_id[:12]}, begun {_at(map_.begun_ns)}, as it was after commit {map_.last}"
            f" ({_at(map_.stamp_ns)}), {wording.entities(self.entities)}{previous}"
        )


def _at(stamp_ns: int) -> str:
    with suppress(OverflowError, OSError, ValueError):
        return f"{datetime.fromtimestamp(stamp_ns / 1e9):%Y-%m-%d %H:%M:%S}"
    return "at an unknown time"


class BackupPart(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A part of the file; `next` requests the following part, and is empty at the end."""

    content: bytes
    next: str = ""


def framed(frame: Frame) -> bytes:
    """Return a frame in the file's encoding."""
    message = _encoder.encode(frame)
    return len(message).to_bytes(_LENGTH, "big") + message


def read(file: Path) -> Iterator[Opening | Piece]:
    """Yield the header of a backup, then its rows, each complete and verified by its digest.

    Raises BadFile if the file is not a backup, or is incomplete or damaged.
    """
    try:
        with file.open("rb") as opened:
            if opened.read(len(MAGIC)) != MAGIC:
                raise BadFile(f"{file} is not a backup; create one with: semmap backup FILE")
            yield from _rows(file, opened)
    except OSError as error:
        raise BadFile(f"{file} cannot be read: {error.strerror}") from None


def verify(file: Path) -> Opening:
    """Verify a whole backup and return its header. Raises BadFile."""
    rows = read(file)
    opening = next(rows)
    if not isinstance(opening, Opening):
        raise BadFile(f"{file}: the header of the backup is missing")
    deque(rows, maxlen=0)
    return opening


def _rows(file: Path, opened: BinaryIO) -> Iterator[Opening | Piece]:
    opening = _frame(file, opened)
    if not isinstance(opening, Opening):
        raise damaged(file)
    yield opening
    chain, last = opening.chain, opening.first - 1
    parts: list[bytes] = []
    begun: tuple[str, int] | None = None
    while isinstance(frame := _frame(file, opened), Piece):
        if begun != (frame.kind, frame.seq):  # a newer checkpoint or shapes replaced incomplete ones
            parts, begun = [], (frame.kind, frame.seq)
        parts.append(frame.content)
        if frame.more:
            continue
        row = msgspec.structs.replace(frame, content=b"".join(parts))
        parts, begun = [], None
        before = chain if row.kind == "commit" else b""
        if hashlib.blake2b(before + row.content, digest_size=16).digest() != row.digest:
            raise damaged(file)
        if row.kind == "commit":
            if row.seq != last + 1:
                raise damaged(file)
            chain, last = row.digest, row.seq
        yield row
    if not isinstance(frame, End) or frame.last != last or (last and chain.hex() != opening.digest):
        raise damaged(file)


def _frame(file: Path, opened: BinaryIO) -> Frame:
    length = opened.read(_LENGTH)
    message = opened.read(int.from_bytes(length, "big"))
    try:
        frame: Frame = _decoder.decode(message)
        return frame
    except msgspec.MsgspecError:
        raise damaged(file) from None


def damaged(file: Path) -> BadFile:
    """Return the error for a damaged backup."""
    return BadFile(f"{file} is damaged or incomplete; use another backup")
