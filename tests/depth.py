"""The number of examples of property-based tests."""

import os


def tries(thorough: int) -> int:
    """Return `count` under `make test-long`, which sets SEMMAP_THOROUGH, otherwise a fifth of it."""
    return thorough if os.environ.get("SEMMAP_THOROUGH") == "1" else -(-thorough // 5)
