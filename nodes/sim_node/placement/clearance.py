"""Where a body can stand: overlap, lifting onto a support, ghosts.

Maps say where things are, not always possibly so: a cup and a table at one spot, two cupboards in one
place. Nothing is ever shifted sideways. A thing that a support can carry is lifted onto it; whatever
else would start inside something stays where it is said to be as a *ghost*, seen and not colliding.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

from semmap.nodes.sim_node.placement.obstacles import CLEARANCE_M, GROUND, Obstacles


@dataclass(frozen=True)
class Placed:
    """What became of one body: lifted by `rise_m`, or a ghost, as the body `in_the_way` fills its place."""

    rise_m: float = 0.0
    ghost: bool = False
    in_the_way: int | None = None


def place(obstacles: Obstacles, rows: Sequence[int]) -> dict[int, Placed]:
    """Find room for the bodies `rows`, the biggest first, among all others, which stay.

    A standing body that a newcomer is meant to carry is lifted onto it, so it may be in the answer too.
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
    """Raise the body onto the lowest surface where it is free, from the first of `onto` up if any is named.

    Answers by how much [m], or None if there is no such surface.
    """
    start = float(obstacles.body_low[row, 2])
    reached = not onto
    for top, owner in obstacles.surfaces(row):
        reached = reached or owner in onto
        if not reached:
            continue
        obstacles.raise_(row, top + CLEARANCE_M - float(obstacles.body_low[row, 2]))
        if not obstacles.hits(row, CLEARANCE_M / 2):
            return float(obstacles.body_low[row, 2]) - start
    obstacles.raise_(row, start - float(obstacles.body_low[row, 2]))
    return None
