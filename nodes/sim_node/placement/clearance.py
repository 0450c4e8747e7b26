"""Where a body can stand: overlap, lifting onto a support, ghosts.

Maps say where things are, not always possibly so: a cup and a table at one spot, two cupboards in one
place. Nothing is ever shifted sideways. A thing that a support can carry is lifted onto it; whatever
else would start inside something stays where it is said to be as a *ghost*, seen and not colliding.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

from semmap.nodes.sim_node.placement.obstacles import CLEARANCE_M, GROUND, Stage


@dataclass(frozen=True)
class Placed:
    """What became of one body: lifted by `rise_m`, or a ghost, as the body `in_the_way` fills its place."""

    rise_m: float = 0.0
    ghost: bool = False
    in_the_way: int | None = None


def place(stage: Stage, rows: Sequence[int]) -> dict[int, Placed]:
    """Find room for the bodies `rows`, the biggest first, among all others, which stay.

    A standing body that a newcomer is meant to carry is lifted onto it, so it may be in the answer too.
    """
    stage.standing[list(rows)] = False
    queue = deque(sorted(rows, key=lambda row: (not stage.is_fixed(row), -stage.volume[row])))
    verdicts: dict[int, Placed] = {}
    pushed: set[int] = set()
    while queue:
        row = queue.popleft()
        hits = stage.hits(row)
        yielding = [other for other in hits if _yields(stage, other, row) and other not in pushed]
        if hits and len(yielding) == len(hits):
            pushed.update(yielding)
            stage.standing[yielding] = False
            queue.extend(yielding)
            hits = []
        onto = [] if hits else stage.shared_spot(row)
        rise = _lift(stage, row, onto) if (hits and not stage.is_fixed(row)) or onto else None
        stage.standing[row] = rise is not None or not hits
        if stage.standing[row]:
            sharing = [other for other in stage.small_at_spot(row) if other not in pushed]
            pushed.update(sharing)
            stage.standing[sharing] = False
            queue.extend(sharing)
        ghost = not stage.standing[row]
        filling = next((other for other in (*hits, *onto) if other != GROUND), None) if ghost else None
        verdicts[row] = Placed(rise_m=rise or 0.0, ghost=ghost, in_the_way=filling)
    return verdicts


def _yields(stage: Stage, other: int, newcomer: int) -> bool:
    return (
        other != GROUND
        and not stage.is_fixed(other)
        and stage.carries(newcomer, other)
        and bool(stage.volume[other] < 0.2 * stage.volume[newcomer])
    )


def _lift(stage: Stage, row: int, onto: list[int]) -> float | None:
    """Raise the body onto the lowest surface where it is free, from the first of `onto` up if any is named.

    Answers by how much [m], or None if there is no such surface.
    """
    start = float(stage.body_low[row, 2])
    reached = not onto
    for top, owner in stage.surfaces(row):
        reached = reached or owner in onto
        if not reached:
            continue
        stage.raise_(row, top + CLEARANCE_M - float(stage.body_low[row, 2]))
        if not stage.hits(row, CLEARANCE_M / 2):
            return float(stage.body_low[row, 2]) - start
    stage.raise_(row, start - float(stage.body_low[row, 2]))
    return None
