"""What survives a restart: the journal, and what is made of it.

`journal/` is the file itself, `encoding/` the layout of what is in it. `history.py` reads the past from it,
`seed.py` begins a new one; `backup/`, `compaction/` and `repair/` are what `semmap backup`, `compact` and
`repair` do.
"""
