"""Floor plans: entities and walls as outlines."""

from __future__ import annotations

from collections.abc import Iterable

from semmap.nodes.kb_node.relations.geometry.solids import solid_of
from semmap.schemas.entities import Entity, Stated
from semmap.schemas.plans import Corners, Outline, Plan, PlannedPlace, PlannedThing
from semmap.schemas.polygons import Polygon, extent_of

_NO_WALLS = "no simulator provides the walls, so they are assumed where there is neither a place nor a door"


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
