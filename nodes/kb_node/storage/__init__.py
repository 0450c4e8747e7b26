"""Persistent storage: the journal, and what is derived from it.

`journal/` is the file itself, `encoding/` the layout of its contents. `history.py` reads the past from it,
and `seed.py` starts a new one. `backup/`, `compaction/` and `repair/` implement `semmap backup`, `compact`
and `repair`.
"""
