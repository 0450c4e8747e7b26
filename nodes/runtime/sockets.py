"""Where the Unix sockets of this machine's processes are."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path
from typing import Final

_LONGEST: Final = 100
"""The longest path of a socket in bytes; Linux allows 107, macOS 103."""


def socket_folder(name: str) -> Path:
    """Return the temporary folder, or `/tmp` if the path of the socket `name` in it would be too long."""
    folder = Path(tempfile.gettempdir())
    return folder if len(os.fsencode(folder / name)) <= _LONGEST else Path("/tmp")
