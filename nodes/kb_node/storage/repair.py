"""A journal that is damaged: going on from the last good commit."""

from __future__ import annotations

import os
import struct
import time
from collections.abc import Callable
from itertools import count
from pathlib import Path

from nodes.kb_node.documents import ontology_files, rdf
from nodes.kb_node.documents.tbox import tbox_validation
from nodes.kb_node.semantic_map import SemanticMap
from nodes.kb_node.storage import seed
from nodes.kb_node.storage.journal import FILENAME, Journal
from nodes.kb_node.storage.sqlite_file import InUse, NotWritten
from schemas import errors

_TOLD_EVERY_S = 2.0
_MAGIC = b"SQLite format 3\0"
_HEADER = struct.Struct(">16sH10xI")
"""How an SQLite file begins: what it is, the size of a page [bytes], and how many pages there are."""


def repair(data: Path, tell: Callable[[str], None] = lambda text: None, *, tbox: Path | None = None) -> str:
    """Make the journal of folder `data` sound again, up to its last good commit; say what was done.

    Of long work `tell` is told how far it is. The TBox that the map began with is taken from the file `tbox`
    where the journal's own cannot be read.

    The damaged journal is moved to `data/kept/<time>/`. Raises BadFile when there is none, Refused when it is
    in use or holds nothing to go on from.
    """
    path = data / FILENAME
    if not path.exists():
        raise errors.BadFile(f"there is no map in {data}")
    new = path.with_name(f"new-{FILENAME}")
    damaged = _opened(path)
    try:
        if _is_sound(damaged, _counting("checked", tell)):
            return f"nothing is damaged: the map continues from commit {damaged.last}"
        good, reason = _copy(damaged, new, _first_tbox(damaged, tbox), tell)
        reason += _left_out(damaged, good)
    finally:
        damaged.close()
    kept = seed.put_in_place(new, path)
    return f"the map continues from commit {good} ({reason}); the damaged file is kept in {kept}"


def _left_out(damaged: Journal, good: int) -> str:
    """Which commits after the damaged one are lost to the map, as far as that can be told."""
    try:
        last = damaged.last
    except errors.Refused:
        return ""
    return f", and everything after it, up to commit {last}, is dropped" if last > good + 1 else ""


def _opened(path: Path) -> Journal:
    """The journal, also one whose end is missing."""
    try:
        return Journal(path)
    except InUse:
        raise
    except errors.Refused as error:
        if _filled_up(path):
            return _opened(path)
        raise errors.Refused(f"{_reason(error)}; start a new map with --fresh (this one is kept)") from None


def _filled_up(path: Path) -> bool:
    """Was its end missing? SQLite reads nothing of such a file, but what is there when zeros follow."""
    with path.open("rb") as file:
        magic, page_size, pages = _HEADER.unpack(file.read(_HEADER.size).ljust(_HEADER.size))
    length = page_size * pages
    if magic != _MAGIC or path.stat().st_size >= length:
        return False
    os.truncate(path, length)
    return True


def _counting(done: str, tell: Callable[[str], None]) -> Callable[[], None]:
    """A function to call after each commit; now and then it tells how many there were."""
    numbers, due_s = count(1), time.monotonic() + _TOLD_EVERY_S

    def progress() -> None:
        nonlocal due_s
        number = next(numbers)
        if time.monotonic() >= due_s:
            due_s = time.monotonic() + _TOLD_EVERY_S
            tell(f"{number:,} commits {done}")

    return progress


def _is_sound(journal: Journal, progress: Callable[[], None]) -> bool:
    try:
        journal.verify(progress)
    except errors.Refused:
        return False
    return journal.is_whole()


def _first_tbox(damaged: Journal, instead: Path | None) -> bytes:
    """The TBox (N-Triples) that the map began with, or what is there in its place."""
    try:
        return damaged.tbox(0)
    except errors.Refused as error:
        if instead is None:
            raise errors.Refused(
                f"{_reason(error)}: the TBox that the map started with cannot be read; provide it with"
                f" --tbox FILE, or start a new map with --fresh (the damaged file is kept)"
            ) from None
    triples = ontology_files.gather([instead], {}).triples
    tbox_validation.compiled(triples, str(instead))
    return rdf.serialise(triples, "ntriples")


def _reason(error: errors.Refused) -> str:
    """What is wrong, without how one goes on."""
    return error.text.partition("; ")[0]


def _copy(damaged: Journal, new: Path, tbox: bytes, tell: Callable[[str], None]) -> tuple[int, str]:
    """A sound journal at `new` with the good commits: the last one's number, and what the next one lacked."""
    seed.remove(new)
    journal = Journal.create(new, tbox)
    good, reason = 0, "all of them are good"
    progress = _counting("saved", tell)
    try:
        with journal.together():
            try:
                for commit in damaged.commits():
                    journal.append(commit, damaged.tbox(commit.seq) if commit.tbox else None)
                    good = commit.seq
                    progress()
            except NotWritten:
                raise
            except errors.Refused as error:
                reason = _reason(error).removeprefix(f"{damaged.path}: ")
        tell(f"the map is rebuilt from {good:,} commits")
        SemanticMap(journal).checkpoint()
    finally:
        journal.close()
    return good, reason
