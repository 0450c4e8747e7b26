"""Floor plans and routes: the knowledge base computes them with the walls of the simulated world."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future
from typing import TypeVar

from semmap.nodes.coordinator.reconciler.reconciler import AskSim, Reconciler
from semmap.nodes.runtime.futures import settle
from semmap.schemas import commands as c
from semmap.schemas import errors
from semmap.schemas.bridge import PlanOf, WayOf
from semmap.schemas.calls import Call
from semmap.schemas.plans import Outline, Plan, WallsQuery, Way

R = TypeVar("R")
Walls = tuple[Outline, ...] | None
"""None if they are unknown."""


class WallQueries:
    """Forwards queries to the knowledge base with the walls of the simulated world."""

    def __init__(self, reconciler: Reconciler, ask: AskSim, ask_map: AskSim) -> None:
        """`ask(call)` calls the simulator, `ask_map(call)` the knowledge base. Neither waits."""
        self._reconciler = reconciler
        self._ask = ask
        self._ask_map = ask_map

    def plan(self, command: c.PlanFloor) -> Future[Plan]:
        """Return the floor plan of the map."""
        return self._with_walls(lambda walls: PlanOf(as_of=command.as_of, walls=walls))

    def route(self, command: c.FindWay) -> Future[Way]:
        """Return a route through the map."""
        return self._with_walls(
            lambda walls: WayOf(
                from_=command.from_,
                to=command.to,
                radius=command.radius,
                heights=command.heights,
                as_of=command.as_of,
                walls=walls,
            )
        )

    def _with_walls(self, call: Callable[[Walls], Call[R]]) -> Future[R]:
        if not self._reconciler.scene.known:
            return self._ask_map(call(None))
        future: Future[R] = Future()
        found = self._ask(WallsQuery())
        found.add_done_callback(lambda done: settle(future, lambda: self._ask_map(call(_walls(done)))))
        return future


def _walls(found: Future[tuple[Outline, ...]]) -> Walls:
    """Return the walls; None if the simulator has ended in the meantime."""
    try:
        return found.result()
    except errors.NoAnswer:
        return None
