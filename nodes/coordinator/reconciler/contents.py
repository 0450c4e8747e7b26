"""Finds the bodies inside a body with joints, which its drawers and doors move along."""

from __future__ import annotations

import math
from collections.abc import Iterable

from semmap.schemas.entities import relative
from semmap.schemas.scenes import Body

_MARGIN_M = 0.02


def find_contents(whole: Body, bodies: Iterable[Body]) -> list[str]:
    """Return the names of the loose bodies in the box around a body, including its open drawers."""
    x, y, z = whole.pose.position_m
    half = [side / 2.0 + _MARGIN_M + _travel(whole) for side in whole.size_m[:2]]
    far = math.hypot(half[0], half[1], whole.size_m[2])
    found = []
    for body in bodies:
        if body.fixed or body.held_by or body.part_of or body.robot or body.name == whole.name:
            continue
        there = body.pose.position_m
        if abs(there[0] - x) > far or abs(there[1] - y) > far or abs(there[2] - z) > far:
            continue
        a, b, c = relative(body.pose, whole.pose).position_m
        if abs(a) <= half[0] and abs(b) <= half[1] and -_MARGIN_M <= c < whole.size_m[2] - _MARGIN_M:
            found.append(body.name)
    return found


def _travel(whole: Body) -> float:
    """Return the range of its longest drawer [m]."""
    ways = [abs(j.open_end - j.closed) for j in whole.joints if j.kind == "slide" and j.closed is not None]
    return max(ways, default=0.0)
