"""Steps of entities by the arrow keys, along the axes of the map as they are seen."""

from __future__ import annotations

import math
from typing import Final

STEP_M: Final = 0.1
FINE_STEP_M: Final = 0.01
"""The step while Shift is held."""
FINE: Final = "Shift+"
_QUARTERS: Final = {"ArrowRight": 0, "ArrowUp": 1, "ArrowLeft": 2, "ArrowDown": 3}
"""Quarter turns from the right of the view."""
KEYS: Final = (*_QUARTERS, *(f"{FINE}{arrow}" for arrow in _QUARTERS))


def step_of(key: str, heading_rad: float) -> tuple[float, float]:
    """Return the step of a key in `KEYS` along x and y [m], for a viewer with this heading about z.

    It is along the axis that is nearest to the direction of the arrow as the viewer sees it, so that entities
    stay aligned with walls. At a heading of pi / 2, up is +y.
    """
    length_m = FINE_STEP_M if key.startswith(FINE) else STEP_M
    quarters = _QUARTERS[key.removeprefix(FINE)] + round(heading_rad / (math.pi / 2.0)) - 1
    x, y = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[quarters % 4]
    return x * length_m, y * length_m
