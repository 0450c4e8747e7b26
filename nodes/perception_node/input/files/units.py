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
_STATED_M = (0.03, 20.0)
"""The same limits for a unit that was stated: a close-up and a hall are possible."""


class Doubt(NamedTuple):
    """The evidence against a unit, the likely unit, and its scale in metres."""

    why: str
    unit: str
    scale_m: float

    def __str__(self) -> str:
        return f"{self.why}; the unit is probably {self.unit}"


def doubt(numbers: NDArray[Any], scale_m: float, *, stated: bool = False) -> Doubt | None:
    """Return the evidence against `scale_m` metres per unit of depth `numbers`; values <= 0 are ignored.

    An image of near things only may be in any unit, so centimetres are detected only below 10 cm. A `stated`
    unit is doubted only if it is impossible.
    """
    seen = numbers[np.isfinite(numbers) & (numbers > 0)]
    if not len(seen):
        return None
    near_m, end_m = float(np.quantile(seen, 0.05)) * scale_m, float(seen.max()) * scale_m
    within_m, far_m = _STATED_M if stated else (_WITHIN_M, _FAR_M)
    if near_m > far_m:
        why = f"half of its depth is beyond {float(np.median(seen)) * scale_m:.0f} m"
    elif end_m < within_m:
        why = f"its depth ends at {end_m:.2g} m"
    else:
        return None
    if scale_m > 1.0 and doubt(seen, 1.0 / scale_m) is None:  # units per metre, and not metres per unit
        return Doubt(why, f"1/{scale_m:g} m", 1.0 / scale_m)
    scale = likely(seen)
    return Doubt(why, _UNITS[scale], scale)


def likely(depth: NDArray[Any]) -> float:
    """Return the metres per unit for which the median depth is closest to one metre."""
    middle = float(np.median(depth))
    return min(_UNITS, key=lambda scale_m: abs(math.log(middle * scale_m)))


def name(scale_m: float) -> str:
    """Return the name of a unit."""
    return _UNITS[scale_m]
