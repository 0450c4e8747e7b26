"""Floor plans and routes through the map, now and in the past, computed in other threads."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import Future
from typing import Protocol, TypeVar

from semmap.nodes.kb_node.answers.plans import plan_of
from semmap.nodes.kb_node.relations.selection import resolve_single
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.storage.history import HistoryReader
from semmap.nodes.navigation.path_planning import find_path, parse_position
from semmap.schemas.bridge import PlanOf, WayOf
from semmap.schemas.entities import Entity
from semmap.schemas.moments import When
from semmap.schemas.plans import Plan, Way

R = TypeVar("R")


class ThreadRunner(Protocol):
    """Runs a function in another thread."""

    def __call__(self, function: Callable[[], R]) -> Future[R]:
        """Return the future result of `function()`."""
        ...


class RoutePlanning:
    """Computes plans and routes. Owned by the node's thread; `aside` runs functions in other threads."""

    def __init__(self, semantic_map: SemanticMap, past: HistoryReader, run_in_thread: ThreadRunner) -> None:
        self._map = semantic_map
        self._past = past
        self._run_in_thread = run_in_thread

    def compute_plan(self, query: PlanOf) -> Future[Plan]:
        """Return the plan of the map."""
        entities = self._entities(query.as_of)

        def plan() -> Plan:
            return plan_of(entities(), query.walls)

        return self._run_in_thread(plan)

    def compute_route(self, query: WayOf) -> Future[Way]:
        """Return a route through the map. Raises UnknownName; Refused if there is none."""
        entities = self._entities(query.as_of)

        def way() -> Way:
            present = entities()
            ends = [parse_position(word) or _named(present, word) for word in (query.from_, query.to)]
            return find_path(plan_of(present, query.walls), ends[0], ends[1], query.radius, query.heights)

        return self._run_in_thread(way)

    def _entities(self, as_of: When | None) -> Callable[[], Sequence[Entity]]:
        """Return a function for the entities. Only this thread may read the present ones."""
        if as_of is not None:
            return lambda: self._past.entities(as_of, None, ())
        now = tuple(self._map.entities())
        return lambda: now


def _named(present: Sequence[Entity], word: str) -> str:
    """Return the name that a word means. Raises UnknownName; BadRequest for an ambiguous word."""
    return word if any(entity.name == word for entity in present) else resolve_single(present, word)
