"""Detection of an existing map in a data folder. Separate from `seed.py`, whose import is slow."""

from __future__ import annotations

from pathlib import Path

from semmap.nodes.kb_node.storage.journal import FILENAME, Journal


def describe_existing_map(data: Path) -> str | None:
    """Return the notice about the map in folder `data`, or None if there is none.

    Raises InUse, or Refused if it cannot be read.
    """
    path = data / FILENAME
    if not path.exists():
        return None
    Journal(path).close()
    return f"continuing with the map in {data} (--fresh starts a new one and keeps this one)"
