"""A cache of the closure of a TBox, stored beside the journal for a fast start."""

from __future__ import annotations

import hashlib
import zlib
from collections.abc import Collection
from contextlib import suppress
from pathlib import Path

from msgspec import MsgspecError

from semmap.nodes.kb_node.reasoner import Reasoner
from semmap.nodes.kb_node.reasoner.rules.facts import Facts, pack, unpack
from semmap.nodes.kb_node.storage import conclusions_format
from semmap.schemas.explanations import Triple

_SUFFIX = ".closure"
_DIGEST_BYTES = 16


def load_reasoner(tbox: Collection[Triple], folder: Path, *, of_the_past: bool = False) -> Reasoner:
    """Return a reasoner with the TBox. Raises Inconsistent.

    A cached closure is used only for the same triples and format, and if it is not damaged. The closure of
    a TBox `of_the_past` is not stored, because the next start needs the current one.
    """
    closed = _read(_path(tbox, folder))
    found = Reasoner(tbox, closed=closed)
    if closed is None and not of_the_past:
        save(found.closed, tbox, folder)
    return found


def save(closed: Facts | None, tbox: Collection[Triple], folder: Path) -> None:
    """Store the closure of a TBox, if it has its own and the folder is writable."""
    if closed is None:
        return
    body = zlib.compress(pack(closed), 1)
    with suppress(OSError):  # then the next start computes it again
        for old in folder.glob(f"*{_SUFFIX}"):
            old.unlink(missing_ok=True)
        _path(tbox, folder).write_bytes(_digest(body) + body)


def _path(tbox: Collection[Triple], folder: Path) -> Path:
    name = hashlib.blake2b(conclusions_format.format_mark(), digest_size=_DIGEST_BYTES)
    for triple in sorted(tbox):
        name.update("\n".join(triple).encode())
    return folder / f"{name.hexdigest()}{_SUFFIX}"


def _read(path: Path) -> Facts | None:
    try:
        content = path.read_bytes()
        body = content[_DIGEST_BYTES:]
        return unpack(zlib.decompress(body)) if content == _digest(body) + body else None
    except (OSError, zlib.error, MsgspecError):
        return None


def _digest(body: bytes) -> bytes:
    return hashlib.blake2b(body, digest_size=_DIGEST_BYTES).digest()
