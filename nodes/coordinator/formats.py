"""The entity list in the formats of other systems."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from semmap.schemas import errors
from semmap.schemas.entities import Entity


def lu4r(entities: Iterable[Entity]) -> dict[str, Any]:
    """Return the input document of LU4R; an entity without a position has no `coordinate`."""
    return {"entities": [_lu4r(entity) for entity in entities]}


def legacy(entities: Iterable[Entity], class_iris: dict[str, str]) -> dict[str, Any]:
    """Return the format of the legacy system, an object keyed by IRI."""
    return {entity.iri: _legacy(entity, class_iris[entity.class_]) for entity in entities}


def _lu4r(entity: Entity) -> dict[str, Any]:
    described: dict[str, Any] = {
        "atom": entity.name,
        "type": entity.class_,
        "preferredLexicalReference": entity.preferred_reference or "",
        "alternativeLexicalReferences": list(entity.alternative_references),
    }
    if entity.pose is not None:
        described["coordinate"] = {**_xyz(entity), "angle": str(entity.pose.yaw_rad)}
    return described


def _legacy(entity: Entity, class_iri: str) -> dict[str, Any]:
    described: dict[str, Any] = {
        "type_full": class_iri,
        "preferredLexicalReference": entity.preferred_reference or "",
        "atom": entity.name,
        "type": entity.class_,
    }
    if entity.pose is not None:
        described["coordinate"] = _xyz(entity)
        described["coordinates"] = ",".join(_xyz(entity).values())
    return described


def _xyz(entity: Entity) -> dict[str, str]:
    if entity.pose is None:
        raise errors.InternalError(f"{entity.name} has no pose")
    return dict(zip("xyz", map(str, map(float, entity.pose.position_m)), strict=True))
