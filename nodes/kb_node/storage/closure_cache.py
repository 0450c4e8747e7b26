"""The closure of a TBox, kept beside the journal so that a start need not work it out again."""

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
    """A reasoner with the TBox. Raises Inconsistent.

    What is in `folder` counts only for the same triples and the same format, and if it is not damaged. The
    closure of a TBox `of_the_past` is not written down: the next start needs the present one's.
    """
    closed = _read(_path(tbox, folder))
    found = Reasoner(tbox, closed=closed)
    if closed is None and not of_the_past:
        save(found.closed, tbox, folder)
    return found


def save(closed: Facts | None, tbox: Collection[Triple], folder: Path) -> None:
    """Write down the closure of a TBox, if it has one of its own and the folder takes it."""
    if closed is None:
        return
    body = zlib.compress(pack(closed), 1)
    with suppress(OSError):  # then the next start works it out again
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
