"""How often a claim is tried that holds for any input: more often where there is time."""

import os


def tries(thorough: int) -> int:
    """All of them under `make test-long`, which sets SEMMAP_THOROUGH; a third of them else."""
    return thorough if os.environ.get("SEMMAP_THOROUGH") == "1" else -(-thorough // 3)
