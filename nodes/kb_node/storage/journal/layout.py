"""The tables of a journal, and the formats that this version reads."""

from __future__ import annotations

from typing import Final

FILENAME: Final = "journal.sqlite"
SCHEMA: Final = """
CREATE TABLE meta (key TEXT PRIMARY KEY, value BLOB NOT NULL) STRICT;
CREATE TABLE tboxes (seq INTEGER PRIMARY KEY, value BLOB NOT NULL, digest BLOB NOT NULL) STRICT;
CREATE TABLE commits (
    seq INTEGER PRIMARY KEY, command_id TEXT NOT NULL, body BLOB NOT NULL, digest BLOB NOT NULL
) STRICT;
CREATE UNIQUE INDEX commits_by_command ON commits (command_id);
CREATE TABLE touches (name TEXT, seq INTEGER, PRIMARY KEY (name, seq)) STRICT, WITHOUT ROWID;
CREATE TABLE checkpoints (seq INTEGER PRIMARY KEY, body BLOB NOT NULL, digest BLOB NOT NULL) STRICT;
"""
FORMAT: Final = b"4"
COMPACTED: Final = b"5"
"""The format of a journal that starts with a snapshot, which older versions report as damaged."""
