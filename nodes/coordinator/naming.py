"""Names and places for what comes without."""

from __future__ import annotations

import math
import re
from collections.abc import Container, Iterable, Iterator

from schemas.entities import Entity, Size, Vector

DEFAULT_POSITION: Vector = (2.0, 2.0, 0.0)
_STEP_M = 0.5
_GAP_M = 0.1
_USUAL_SIZE: Size = (0.5, 0.5, 0.5)


def free_name(class_name: str, taken: Container[str]) -> str:
    """The class in lower case and the first number that is free: `chair1`."""
    stem = re.sub(r"[^a-z0-9_.-]", "", class_name.lower())
    stem = stem if stem[:1].isalpha() else f"_{stem}"
    number = 1
    while f"{stem}{number}" in taken:
        number += 1
    return f"{stem}{number}"


def free_position(entities: Iterable[Entity], size_m: Size | None) -> Vector:
    """The place nearest to the default position where nothing stands within reach of a thing of `size_m`."""
    discs = [
        (e.pose.position_m[0], e.pose.position_m[1], _radius_m(e.size_m))
        for e in entities
        if e.pose is not None and not e.place
    ]
    radius_m = _radius_m(size_m)
    for x, y in _spiral():
        if all(math.hypot(x - ox, y - oy) > radius_m + reach_m + _GAP_M for ox, oy, reach_m in discs):
            return (x, y, DEFAULT_POSITION[2])
    raise AssertionError("the spiral is endless")


def _radius_m(size_m: Size | None) -> float:
    x, y, _ = size_m or _USUAL_SIZE
    return math.hypot(x, y) / 2.0


def _spiral() -> Iterator[tuple[float, float]]:
    """Points around the default position, ring by ring."""
    x0, y0, _ = DEFAULT_POSITION
    yield x0, y0
    ring = 1
    while True:
        for k in range(8 * ring):
            angle = 2.0 * math.pi * k / (8 * ring)
            yield (
                round(x0 + ring * _STEP_M * math.cos(angle), 3),
                round(y0 + ring * _STEP_M * math.sin(angle), 3),
            )
        ring += 1
