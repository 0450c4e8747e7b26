"""Detects the unit of depth values. Pure."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

_UNITS = {
    1.0: "metres",
    0.01: "centimetres",
    0.001: "millimetres",
    0.0001: "tenths of a millimetre",
}
"""Metres per unit."""
_FAR_M = 6.0
"""In a room something is nearer; beyond this distance nothing is recognised."""
_WITHIN_M = 0.1
"""An image contains something farther than this."""


class Doubt(NamedTuple):
    """The evidence against a unit, the likely unit, and its scale in metres."""

    why: str
    unit: str
    scale_m: float

    def __str__(self) -> str:
        return f"{self.why}; the unit is probably {self.unit}"


def doubt(numbers: NDArray[Any], scale_m: float) -> Doubt | None:
    """Return the evidence against `scale_m` metres per unit of depth `numbers`; values <= 0 are ignored.

    An image of near things only may be in any unit, so centimetres are detected only below 10 cm.
    """
    seen = numbers[np.isfinite(numbers) & (numbers > 0)]
    if not len(seen):
        return None
    near_m, end_m = float(np.quantile(seen, 0.05)) * scale_m, float(seen.max()) * scale_m
    if near_m > _FAR_M:
        why = f"half of its depth is beyond {float(np.median(seen)) * scale_m:.0f} m"
    elif end_m < _WITHIN_M:
        why = f"its depth ends at {end_m:.3f} m"
    else:
        return None
    scale = likely(seen)
    return Doubt(why, _UNITS[scale], scale)


def likely(depth: NDArray[Any]) -> float:
    """Return the metres per unit for which the median depth is closest to one metre."""
    middle = float(np.median(depth))
    return min(_UNITS, key=lambda scale_m: abs(math.log(middle * scale_m)))


def name(scale_m: float) -> str:
    """Return the name of a unit."""
    return _UNITS[scale_m]
