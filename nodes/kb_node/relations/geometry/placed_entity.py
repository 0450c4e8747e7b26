"""The part of an entity that relations depend on, as sent to another process that computes them."""

from __future__ import annotations

from typing import Literal

from msgspec import Struct

from semmap.nodes.kb_node.relations.geometry.opening import AS_DRAWN, Positions, positions_of
from semmap.ontology.model_shapes import is_of_world, model_in_world, own_size_m
from semmap.schemas.attachments import holder_of
from semmap.schemas.entities import Entity, Pose, Size
from semmap.schemas.polygons import EXTENT


class PlacedEntity(Struct, frozen=True, kw_only=True, array_like=True):
    """The location and size of an entity, with the field names of `Entity`."""

    name: str
    iri: str
    pose: Pose | None
    size_m: Size | None
    place: bool
    model: str
    extent: str = ""
    """The WKT of a place whose extent is a polygon."""
    held_by: str = ""
    """The holder to which it is attached, or ""."""
    joints: Positions = AS_DRAWN
    """The joint positions of its model."""
    fixed: bool = False
    """Whether it is mounted and does not settle."""

    @classmethod
    def of(cls, entity: Entity) -> PlacedEntity:
        """Return the relevant part of an entity."""
        return cls(
            name=entity.name,
            iri=entity.iri,
            pose=entity.pose,
            size_m=entity.size_m,
            place=entity.place,
            model=model_of(entity),
            extent=extent_in(entity),
            held_by=holder_in(entity),
            joints=joints_in(entity),
            fixed=entity.fixed,
        )


def model_of(entity: Entity | PlacedEntity) -> str:
    """Return the model of an entity's shape: its body in the world file, or that of its class."""
    if isinstance(entity, PlacedEntity) or entity.place:
        return entity.model
    return model_in_world(entity.name, entity.model, entity.size_m)


def name_shape_source(entity: Entity) -> Literal["", "world", "model", "box"]:
    """Return whence the shape of an entity is: the world file, its model, or its size. "" for a place."""
    if entity.place:
        return ""
    model = model_of(entity)
    if is_of_world(model):
        return "world"
    return "model" if model and own_size_m(model) is not None else "box"


def holder_in(entity: Entity | PlacedEntity) -> str:
    """Return the holder to which an entity is attached, or ""."""
    if isinstance(entity, PlacedEntity):
        return entity.held_by
    return holder_of(entity) if entity.grip_provenance is not None else ""


def joints_in(entity: Entity | PlacedEntity) -> Positions:
    """Return the joint positions of an entity's model, as far as the map states them."""
    if isinstance(entity, PlacedEntity):
        return entity.joints
    if not entity.properties:
        return AS_DRAWN
    model = model_of(entity)
    return positions_of(model, entity.size_m or own_size_m(model), entity.properties)


def extent_in(entity: Entity | PlacedEntity) -> str:
    """Return the WKT of a polygon extent, or "" for a box and for objects."""
    if not entity.place:
        return ""
    if isinstance(entity, PlacedEntity):
        return entity.extent
    text = entity.properties.get(EXTENT)
    return text if isinstance(text, str) else ""
