"""Finds a valid place for a body: overlap, lifting onto a support, non-colliding bodies.

Maps may contain impossible poses: a cup and a table at one spot, two cupboards in one place. Bodies are never
shifted sideways. A body is lifted if a support can carry it, but not onto a tower of bodies. Any other body
that would start inside another stays at its pose as a *ghost*: visible, but not colliding.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

from semmap.nodes.sim_node.placement.obstacles import CLEARANCE_M, GROUND, Obstacles

_MOST_STACKED = 10
"""On more bodies at one spot, a body is not stacked: a tower of hundreds would fall on everything around."""

_MOST_TRIED = 12
"""Of more surfaces, the highest is tried next; otherwise hundreds of bodies at one spot take minutes."""


@dataclass(frozen=True)
class Placed:
    """The result for one body: lifted by `rise_m`, or a ghost.

    `in_the_way` is the body that occupies a ghost's place.
    """

    rise_m: float = 0.0
    ghost: bool = False
    in_the_way: int | None = None


def place(obstacles: Obstacles, rows: Sequence[int]) -> dict[int, Placed]:
    """Place the bodies `rows`, largest first, among all others, which stay.

    A body that a new one is meant to carry is lifted onto it, so it may be in the result.
    """
    obstacles.standing[list(rows)] = False
    queue = deque(sorted(rows, key=lambda row: (not obstacles.is_fixed(row), -obstacles.volume[row])))
    verdicts: dict[int, Placed] = {}
    pushed: set[int] = set()
    while queue:
        row = queue.popleft()
        hits = obstacles.hits(row)
        yielding = [other for other in hits if _yields(obstacles, other, row) and other not in pushed]
        if hits and len(yielding) == len(hits):
            pushed.update(yielding)
            obstacles.standing[yielding] = False
            queue.extend(yielding)
            hits = []
        onto = [] if hits else obstacles.shared_spot(row)
        rise = _lift(obstacles, row, onto) if (hits and not obstacles.is_fixed(row)) or onto else None
        obstacles.standing[row] = rise is not None or not hits
        if obstacles.standing[row]:
            sharing = [other for other in obstacles.small_at_spot(row) if other not in pushed]
            pushed.update(sharing)
            obstacles.standing[sharing] = False
            queue.extend(sharing)
        ghost = not obstacles.standing[row]
        filling = next((other for other in (*hits, *onto) if other != GROUND), None) if ghost else None
        verdicts[row] = Placed(rise_m=rise or 0.0, ghost=ghost, in_the_way=filling)
    return verdicts


def _yields(obstacles: Obstacles, other: int, newcomer: int) -> bool:
    return (
        other != GROUND
        and not obstacles.is_fixed(other)
        and obstacles.carries(newcomer, other)
        and bool(obstacles.volume[other] < 0.2 * obstacles.volume[newcomer])
    )


def _lift(obstacles: Obstacles, row: int, onto: list[int]) -> float | None:
    """Raise the body onto the lowest free surface; if `onto` is given, from the first of its surfaces up.

    Returns the rise [m], or None if there is no such surface.
    """
    start = float(obstacles.body_low[row, 2])
    surfaces = obstacles.surfaces(row)
    first = next((at for at, (_, owner) in enumerate(surfaces) if not onto or owner in onto), len(surfaces))
    above = surfaces[first:]
    if len({owner for _, owner in above}) > _MOST_STACKED:
        return None
    for top, _ in above if len(above) <= _MOST_TRIED else (*above[:_MOST_TRIED], above[-1]):
        obstacles.raise_(row, top + CLEARANCE_M - float(obstacles.body_low[row, 2]))
        if not obstacles.hits(row, CLEARANCE_M / 2):
            return float(obstacles.body_low[row, 2]) - start
    obstacles.raise_(row, start - float(obstacles.body_low[row, 2]))
    return None
