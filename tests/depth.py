"""The examples of property-based tests: always the same few, or under `make test-long` many new ones."""

import os
from typing import Final

IS_THOROUGH: Final = os.environ.get("SEMMAP_THOROUGH") == "1"
"""Whether `make test-long` runs the tests."""


def tries(thorough: int) -> int:
    """Return `thorough` under `make test-long`, otherwise a fifth of it."""
    return thorough if IS_THOROUGH else -(-thorough // 5)
