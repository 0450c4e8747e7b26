"""An entity as far as relations need it: what is sent to another process that works them out."""

from __future__ import annotations

from msgspec import Struct

from semmap.nodes.kb_node.relations.geometry.opening import AS_DRAWN, Positions, positions_of
from semmap.ontology.model_shapes import own_size_m
from semmap.schemas.attachments import holder_of
from semmap.schemas.entities import Entity, Pose, Size
from semmap.schemas.polygons import EXTENT


class Placed(Struct, frozen=True, kw_only=True, array_like=True):
    """Where an entity is and how large, by the names that `Entity` has for it."""

    name: str
    iri: str
    pose: Pose | None
    size_m: Size | None
    place: bool
    model: str
    extent: str = ""
    """The WKT of a place whose extent is a polygon."""
    held_by: str = ""
    """What grasps it; "" for nothing."""
    joints: Positions = AS_DRAWN
    """Where the joints of its model stand."""

    @classmethod
    def of(cls, entity: Entity) -> Placed:
        """As much of an entity."""
        return cls(
            name=entity.name,
            iri=entity.iri,
            pose=entity.pose,
            size_m=entity.size_m,
            place=entity.place,
            model=entity.model,
            extent=extent_in(entity),
            held_by=holder_in(entity),
            joints=joints_in(entity),
        )


def holder_in(entity: Entity | Placed) -> str:
    """What grasps an entity; "" for nothing."""
    if isinstance(entity, Placed):
        return entity.held_by
    return holder_of(entity) if entity.grip_provenance is not None else ""


def joints_in(entity: Entity | Placed) -> Positions:
    """Where the joints of an entity's model stand, as far as the map states it."""
    if isinstance(entity, Placed):
        return entity.joints
    if not entity.properties:
        return AS_DRAWN
    return positions_of(entity.model, entity.size_m or own_size_m(entity.model), entity.properties)


def extent_in(entity: Entity | Placed) -> str:
    """The WKT of an extent that is a polygon; "" for one that is a box, and for what is no place."""
    if not entity.place:
        return ""
    if isinstance(entity, Placed):
        return entity.extent
    text = entity.properties.get(EXTENT)
    return text if isinstance(text, str) else ""
