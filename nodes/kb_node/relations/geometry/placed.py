"""An entity as far as relations need it: what is sent to another process that works them out."""

from __future__ import annotations

from msgspec import Struct

from schemas.entities import Entity, Pose, Size


class Placed(Struct, frozen=True, kw_only=True, array_like=True):
    """Where an entity is and how large, by the names that `Entity` has for it."""

    name: str
    iri: str
    pose: Pose | None
    size_m: Size | None
    place: bool
    model: str

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
        )
