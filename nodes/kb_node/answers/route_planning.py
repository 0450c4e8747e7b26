"""Floor plans and routes through the map, now and in the past, computed in other threads."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import Future
from typing import Protocol, TypeVar

from semmap.nodes.kb_node.relations.geometry.solids import solid_of
from semmap.nodes.kb_node.relations.selection import resolve_single
from semmap.nodes.kb_node.semantic_map import SemanticMap
from semmap.nodes.kb_node.storage.history import HistoryReader
from semmap.nodes.navigation.path_planning import find_path, parse_position
from semmap.schemas.bridge import PlanOf, WayOf
from semmap.schemas.entities import Entity, Stated
from semmap.schemas.moments import When
from semmap.schemas.plans import Corners, Outline, Plan, PlannedPlace, PlannedThing, Way
from semmap.schemas.polygons import Polygon, extent_of

R = TypeVar("R")
_NO_WALLS = "no simulator provides the walls, so they are assumed where there is neither a place nor a door"


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
            ends = [parse_position(word) or resolve_single(present, word) for word in (query.from_, query.to)]
            return find_path(plan_of(present, query.walls), ends[0], ends[1], query.radius, query.heights)

        return self._run_in_thread(way)

    def _entities(self, as_of: When | None) -> Callable[[], Sequence[Entity]]:
        """Return a function for the entities. Only this thread may read the present ones."""
        if as_of is not None:
            return lambda: self._past.entities(as_of, None, ())
        now = tuple(self._map.entities())
        return lambda: now


def plan_of(entities: Iterable[Entity], walls: tuple[Outline, ...] | None) -> Plan:
    """Return the plan of these entities, sorted by name. `walls` is None if they are unknown."""
    places: list[PlannedPlace] = []
    things: list[PlannedThing] = []
    for entity in sorted(entities, key=lambda e: e.name):
        solid = solid_of(entity)
        if solid is None or not solid.is_measured:
            continue
        if not entity.place:
            parts = tuple(
                Outline(corners=tuple(part.projection), low=part.low[2], high=part.high[2])
                for part in solid.parts
                if len(part.projection) > 2
            )
            is_door = "Door" in entity.types
            things.append(
                PlannedThing(
                    name=entity.name,
                    label=_label(entity),
                    class_=entity.class_,
                    parts=parts,
                    footprint=tuple(solid.outline),
                    door=is_door,
                    open=_flag(entity.properties.get("isOpen")) if is_door else None,
                    connects=_names(entity.properties.get("connects")) if is_door else (),
                )
            )
            continue
        extent = extent_of(entity) or Polygon(tuple(solid.outline))
        places.append(
            PlannedPlace(
                name=entity.name,
                label=_label(entity),
                class_=entity.class_,
                rings=_rings(extent),
                floor=solid.bottom,
                height=solid.top - solid.bottom,
                part="Building_Subparts" in entity.types,
                forbidden=_flag(entity.properties.get("isForbidden")) is True,
            )
        )
    has_walls = bool(walls) or any(thing.class_ == "Wall" for thing in things)
    notes = () if has_walls or not places else (_NO_WALLS,)
    return Plan(places=tuple(places), things=tuple(things), walls=walls or (), notes=notes)


def _rings(polygon: Polygon) -> tuple[Corners, ...]:
    return tuple(tuple(ring) for ring in polygon.rings)


def _label(entity: Entity) -> str:
    return entity.preferred_reference or entity.name


def _flag(value: Stated | None) -> bool | None:
    return value if isinstance(value, bool) else None


def _names(value: Stated | None) -> tuple[str, ...]:
    return tuple(map(str, value)) if isinstance(value, tuple) else () if value is None else (str(value),)
