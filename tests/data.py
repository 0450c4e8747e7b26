"""The location of the test data, which is not part of the project."""

from __future__ import annotations

import os
from pathlib import Path

import pytest


def data_folder() -> Path:
    """Return the folder in SEMMAP_DATA; without it, skip the test, or fail it if the data is required."""
    default = Path(__file__).parents[1] / ".." / "shared" / "data"
    folder = Path(os.environ.get("SEMMAP_DATA") or default)
    if not folder.is_dir():
        message = f"no test data at {folder}: set SEMMAP_DATA"
        if os.environ.get("SEMMAP_DATA_REQUIRED"):
            pytest.fail(message)
        pytest.skip(message)
    return folder
