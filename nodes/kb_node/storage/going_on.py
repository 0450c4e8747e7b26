"""Whether a data folder has a map to go on with: apart from `seed.py`, which takes long to import."""

from __future__ import annotations

from pathlib import Path

from nodes.kb_node.storage.journal import FILENAME, Journal


def going_on(data: Path) -> str | None:
    """What to say of the map that is in folder `data`; None if there is none.

    Raises InUse, or Refused for one that cannot be read.
    """
    path = data / FILENAME
    if not path.exists():
        return None
    Journal(path).close()
    return f"going on with the map in {data} (--fresh begins anew and keeps this one aside)"
