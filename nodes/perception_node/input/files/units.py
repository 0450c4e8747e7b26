"""In which unit numbers of depth seem to be told. Pure."""

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
"""Metres of 1."""
_FAR_M = 6.0
"""In a room something is nearer, and what is not is too far off to be made out."""
_WITHIN_M = 0.1
"""Something in a picture is farther away."""


class Doubt(NamedTuple):
    """What speaks against a unit, and which it seems to be: its name, and metres of 1."""

    why: str
    unit: str
    scale_m: float

    def __str__(self) -> str:
        return f"{self.why}, as if its numbers were {self.unit}"


def doubt(numbers: NDArray[Any], scale_m: float) -> Doubt | None:
    """What speaks against 1 being `scale_m` metres in depth `numbers`, where those not above 0 are nothing.

    A picture of what is all near by may be in any unit, so centimetres are noticed only below 10 cm.
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
    """Metres of 1 in the unit in which half of these depths are nearest to a metre."""
    middle = float(np.median(depth))
    return min(_UNITS, key=lambda scale_m: abs(math.log(middle * scale_m)))


def name(scale_m: float) -> str:
    """What a unit that is `likely` is called."""
    return _UNITS[scale_m]
