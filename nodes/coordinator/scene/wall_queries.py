"""Plans and ways: the knowledge base works them out, once the simulator has told where the walls are."""

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
"""None where nobody knows them."""


class WallQueries:
    """Passes questions on with the walls of the simulated world."""

    def __init__(self, reconciler: Reconciler, ask: AskSim, ask_map: AskSim) -> None:
        """`ask(call)` asks the simulator, `ask_map(call)` the knowledge base, without waiting."""
        self._reconciler = reconciler
        self._ask = ask
        self._ask_map = ask_map

    def plan(self, command: c.PlanFloor) -> Future[Plan]:
        """The plan of the map."""
        return self._with_walls(lambda walls: PlanOf(as_of=command.as_of, walls=walls))

    def route(self, command: c.FindWay) -> Future[Way]:
        """A way through the map."""
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
    """None where the simulator has gone meanwhile."""
    try:
        return found.result()
    except errors.NoAnswer:
        return None
