"""Flipped bits in checkpoints and in the cached closure of the TBox, on copies of a map's files."""

from __future__ import annotations

import logging
import random
import shutil
import sqlite3
from contextlib import closing
from pathlib import Path
from typing import Any, Final

from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.storage.journal import FILENAME, Journal

_PIECE_BYTES: Final = 64
"""The pages of SQLite divide a checkpoint, so it is found in pieces."""


def try_flips(data: Path, folder: Path, flips: int, chance: random.Random) -> None:
    """Start copies of a stopped map, each with one flipped bit, by turns in a checkpoint and in the closure.

    Raises AssertionError for a start with another map.
    """
    logging.getLogger("semmap.nodes.kb_node.storage").setLevel(logging.ERROR)  # each is a warning
    expected = _state(data)
    for n in range(flips):
        copy = folder / str(n)
        shutil.copytree(data, copy, ignore=shutil.ignore_patterns("recordings", "logs", "*.lock"))
        flip = (flip_checkpoint, flip_closure)[n % 2]
        flip(copy, chance)
        assert _state(copy) == expected, (flip.__name__, n)
        shutil.rmtree(copy)


def flip_checkpoint(data: Path, chance: random.Random) -> None:
    """Flip one bit of the newest checkpoint, in the file."""
    path = data / FILENAME
    with closing(sqlite3.connect(path)) as db:
        query = "SELECT body FROM checkpoints ORDER BY seq DESC LIMIT 1"
        (body,) = db.execute(query).fetchone()
    content = bytearray(path.read_bytes())
    places = [
        found + at
        for start in range(0, len(body) - _PIECE_BYTES, _PIECE_BYTES)
        if (found := content.find(body[start : start + _PIECE_BYTES])) >= 0
        for at in range(_PIECE_BYTES)
    ]
    content[chance.choice(places)] ^= 1 << chance.randrange(8)
    path.write_bytes(content)


def flip_closure(data: Path, chance: random.Random) -> None:
    """Flip one bit of the cached closure."""
    (path,) = data.glob("*.closure")
    content = bytearray(path.read_bytes())
    content[chance.randrange(len(content))] ^= 1 << chance.randrange(8)
    path.write_bytes(content)


def _state(data: Path) -> Any:
    """Return everything that a start reads from a folder."""
    with closing(Journal(data / FILENAME)) as journal:
        read = SemanticMap(journal)
        return read.seq, set(read.abox()), read.snapshot(), set(read.reasoner.inferred())
